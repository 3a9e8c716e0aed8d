"""
A referee that knows all pairs, no grid and no queue.

It replays a log of contacts with formulas of its own: standard quadratics, point-to-segment distances, velocities
from angles and from the frame of the centre of mass. Each contact must be where and when its two bodies first
touch, no pair may touch earlier, and the impulse must be the elastic one. After each contact it takes over the
logged place (rounding grows without bound in a chaotic scene, a fault shows at once).
"""

import math

import numpy as np

CIRCLE, LOCKED, WALL, WALL_END = range(4)


class Fault(AssertionError):
    """A contact that the referee does not accept, or one that is missing."""


class Referee:
    """Follows a scene contact by contact; `tolerance` is in radii of the smallest moving circle."""

    def __init__(self, scene, tolerance=1e-9):
        self.scene = scene
        circles = scene.circles
        self.position = np.array([c.position for c in circles], float)
        self.velocity = np.array([c.velocity for c in circles], float)
        self.radius = np.array([c.radius for c in circles])
        self.mass = np.array([c.mass for c in circles])
        self.locked = np.array([c.locked for c in circles])
        self.walls = np.array([w.start + w.end for w in scene.walls], float).reshape(-1, 4)
        self.now = 0.0
        self.close = tolerance * self.radius[~self.locked].min()
        moving = [i for i, c in enumerate(circles) if not c.locked]
        # Absolute times of the next touch of circle i with (circles, flats, ends).
        self.soonest = {i: self._times(i) for i in moving}

    def _times(self, i):
        return np.concatenate([self._with_circles(i), self._with_flats(i), self._with_ends(i)])

    def _quadratic(self, offset, velocity, reach):
        """Return the first root of |offset + velocity t| = reach by the schoolbook formula."""
        a = (velocity**2).sum(1)
        b = 2 * (velocity * offset).sum(1)
        c = (offset**2).sum(1) - reach**2
        with np.errstate(invalid='ignore', divide='ignore'):
            root = b * b - 4 * a * c
            t = (-b - np.sqrt(root)) / (2 * a)
        hit = (b < 0) & (root > 0)
        # Touching already: the root is zero up to rounding.
        return np.where(hit, self.now + np.maximum(np.where(hit, t, 0), 0), np.inf)

    def _with_circles(self, i):
        t = self._quadratic(
            self.position - self.position[i],
            self.velocity - self.velocity[i],
            self.radius + self.radius[i],
        )
        asked = self.locked | self.scene.moving_circles_collide
        asked[i] = False
        return np.where(asked, t, np.inf)

    def _with_flats(self, i):
        times = []
        for sx, sy, ex, ey in self.walls:
            length = math.dist((sx, sy), (ex, ey))
            along = np.array([(ex - sx) / length, (ey - sy) / length])
            offset = self.position[i] - (sx, sy)
            height = along[0] * offset[1] - along[1] * offset[0]
            rise = along[0] * self.velocity[i, 1] - along[1] * self.velocity[i, 0]
            if height * rise >= 0:
                times.append(np.inf)
                continue
            wait = max(0.0, (abs(height) - self.radius[i]) / abs(rise))
            foot = (offset + self.velocity[i] * wait) @ along
            times.append(self.now + wait if 0 <= foot <= length else np.inf)
        return np.array(times)

    def _with_ends(self, i):
        ends = self.walls.reshape(-1, 2)
        zero = np.zeros(len(ends))
        return self._quadratic(
            ends - self.position[i], zero[:, None] - self.velocity[i], zero + self.radius[i]
        )

    def _place(self, kind, b):
        """Return where the contact stands in a circle's list of times: one, or an end's two."""
        n, w = len(self.radius), len(self.walls)
        if kind in (CIRCLE, LOCKED):
            return [b]
        if kind == WALL:
            return [n + b]
        return [n + w + 2 * b, n + w + 2 * b + 1]

    def _slack(self, *ids):
        """Return how much time the tolerance is worth to the circles concerned."""
        speed = max(np.hypot(*self.velocity[i]) for i in ids)
        return self.close / max(speed, 1e-300)

    def watch(self, contact):
        """Accept one contact, or raise `Fault`."""
        t, a, b, kind = (contact[k] for k in ('time', 'a', 'b', 'kind'))
        for i, times in self.soonest.items():
            if times.min() < t - self._slack(i):
                raise Fault(f'circle {i} touches {times.argmin()} at {times.min()}, before {t}')
        due = min(self.soonest[a][self._place(kind, b)])
        if not abs(due - t) <= self._slack(a, *([b] if kind == CIRCLE else [])) * self._blur(
            contact
        ):
            raise Fault(f'circle {a} touches {kind} {b} at {due}, logged {t}')
        wait = t - self.now
        self.position += self.velocity * wait
        self.now = t
        normal = np.array([contact['nx'], contact['ny']])
        point = np.array([contact['x'], contact['y']])
        self._expect_place(a, point - self.radius[a] * normal)
        self._expect_velocities(contact, '0')
        if kind == CIRCLE:
            self._expect_place(b, point + self.radius[b] * normal)
            impulse = self._exchange(a, b, normal)
        else:
            impulse = self._turn(a, normal)
        self._expect_velocities(contact, '1')
        if not math.isclose(impulse, contact['impulse'], rel_tol=1e-6):
            raise Fault(f'impulse {contact["impulse"]} logged, {impulse} due at {t}')
        for i in (a, b) if kind == CIRCLE else (a,):
            self.soonest[i] = self._times(i)
            if self.scene.moving_circles_collide:
                for j, times in self.soonest.items():
                    times[i] = self.soonest[i][j]

    def _blur(self, contact):
        """Return how much a grazing angle widens the uncertainty of the instant of a contact."""
        normal = np.array([contact['nx'], contact['ny']])
        velocity = self.velocity[contact['a']].copy()
        if contact['kind'] == CIRCLE:
            velocity -= self.velocity[contact['b']]
        return np.hypot(*velocity) / max(abs(velocity @ normal), 1e-300)

    def _expect_place(self, i, place):
        if np.abs(self.position[i] - place).max() > self.close:
            raise Fault(f'circle {i} is at {self.position[i]}, logged {place}, at {self.now}')
        self.position[i] = place

    def _expect_velocities(self, contact, when):
        """Before a contact ('0') and after it ('1'); what is locked has none."""
        for body, number in (('a', contact['a']), ('b', contact['b'])):
            moves = body == 'a' or contact['kind'] == CIRCLE
            due = self.velocity[number] if moves else np.zeros(2)
            logged = np.array([contact[f'{body}x{when}'], contact[f'{body}y{when}']])
            # Velocities of the whole run are near each other's size; close is some digits of a metre.
            if not np.allclose(logged, due, rtol=1e-6, atol=self.close):
                raise Fault(f'velocity {logged} of {body} logged, {due} due at {self.now}')

    def _exchange(self, a, b, normal):
        """In the frame of the centre of mass both velocities are reflected about the normal."""
        total = self.mass[a] + self.mass[b]
        center = (self.mass[a] * self.velocity[a] + self.mass[b] * self.velocity[b]) / total
        closing = (self.velocity[a] - self.velocity[b]) @ normal
        if closing <= 0:
            raise Fault(f'circles {a} and {b} do not approach at {self.now}')
        for i in (a, b):
            inner = self.velocity[i] - center
            self.velocity[i] = center + inner - 2 * (inner @ normal) * normal
        return 2 * self.mass[a] * self.mass[b] / total * closing

    def _turn(self, a, normal):
        """Turn the velocity by the lesson's angles."""
        vx, vy = self.velocity[a]
        closing = self.velocity[a] @ normal
        if closing <= 0:
            raise Fault(f'circle {a} does not approach at {self.now}')
        angle = 2 * math.atan2(normal[1], normal[0]) - math.atan2(vy, vx) + math.pi
        speed = math.hypot(vx, vy)
        self.velocity[a] = speed * math.cos(angle), speed * math.sin(angle)
        return 2 * self.mass[a] * closing

    def until(self, time):
        """No contact was missed up to a time."""
        for i, times in self.soonest.items():
            if times.min() < time - self._slack(i):
                raise Fault(
                    f'circle {i} touches {times.argmin()} at {times.min()}: not in the log'
                )


def replay(scene, contacts, until):
    """Watch a whole log; return how many contacts were accepted."""
    referee = Referee(scene)
    for contact in contacts:
        referee.watch(contact)
    referee.until(until)
    return len(contacts)
