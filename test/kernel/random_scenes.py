"""Random scenes of every kind that the engine must get right. Seeded; plain `random()` only."""

import itertools
import math
import random

from circle_bounce_ros.kernel import Circle, Scene, Wall

KINDS = (
    'box',
    'tilted',
    'mixed',
    'open',
    'thin',
    'pass_through',
    'ends',
    'fast',
    'dense',
    'sizes',
    'seams',
)


def box(x0, y0, x1, y1):
    return polygon([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def polygon(corners):
    return [Wall(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]


def regular_polygon(count, radius, turn):
    angles = [turn + 2 * math.pi * k / count for k in range(count)]
    return polygon([(radius * math.cos(a), radius * math.sin(a)) for a in angles])


def place(rng, count, radii, inside, *, locked=False, speed=1.0, taken=()):
    """Return circles without overlap at random places of a disc of radius `inside`."""
    circles = list(taken)
    new = []
    while len(new) < count:
        radius = radii[len(new) % len(radii)]
        reach = inside - 1.01 * radius
        x, y = (reach * (2 * rng.random() - 1) for _ in 'xy')
        if math.hypot(x, y) > reach:
            continue
        if any(math.dist((x, y), c.position) < 1.01 * (radius + c.radius) for c in circles):
            continue
        angle = 2 * math.pi * rng.random()
        pace = 0.0 if locked else speed * (0.2 + rng.random())
        velocity = (pace * math.cos(angle), pace * math.sin(angle))
        mass = radius * (0.5 + rng.random())
        circle = Circle((x, y), velocity, radius=radius, mass=mass, locked=locked)
        circles.append(circle)
        new.append(circle)
    return new


def random_scene(kind, seed):
    """Return a scene of about 20 circles; `inside` of all that is closed is a disc of radius 10 m."""
    rng = random.Random(f'{kind} {seed}')
    turn = rng.random()
    tilted = regular_polygon(5 + seed % 4, 13.0, turn)
    if kind == 'box':
        circles = place(rng, 20, [0.7], 10.0)
        circles += place(rng, 3, [1.0], 10.0, locked=True, taken=circles)
        return Scene(circles, box(-10, -10, 10, 10))
    if kind == 'tilted':
        circles = place(rng, 20, [0.7], 10.0)
        return Scene(circles, tilted)
    if kind == 'mixed':
        circles = place(rng, 22, [3.0] + [0.3] * 10, 10.0)
        circles += place(rng, 3, [0.5], 10.0, locked=True, taken=circles)
        return Scene(circles, tilted)
    if kind == 'open':
        circles = place(rng, 16, [0.5, 0.2], 6.0)
        circles += place(rng, 12, [0.4], 9.0, locked=True, taken=circles)
        return Scene(circles, [Wall((-9.5, -9.5), (-9.5, 9.5))])
    if kind == 'thin':
        return Scene(place(rng, 20, [0.1], 10.0, speed=5.0), box(-10, -10, 10, 10))
    if kind == 'pass_through':
        circles = place(rng, 20, [0.3], 10.0)
        circles += place(rng, 10, [0.8], 10.0, locked=True, taken=circles)
        return Scene(circles, tilted, moving_circles_collide=False)
    if kind == 'ends':
        needles = []
        for _ in range(12):
            x, y = (16 * rng.random() - 8 for _ in 'xy')
            angle = 2 * math.pi * rng.random()
            tip = (x + math.cos(angle), y + math.sin(angle))
            needles.append(Wall((x, y), tip))
        free = [c for c in place(rng, 60, [0.25], 10.0) if _clear_of(needles, c)]
        return Scene(free[:20], [*tilted, *needles])
    if kind == 'fast':
        circles = place(rng, 12, [0.05], 10.0, speed=3000.0)
        circles += place(rng, 8, [1.0], 10.0, locked=True, taken=circles)
        return Scene(circles, tilted)
    if kind == 'dense':
        # So many that the cells are as narrow as they may be: as wide as a circle.
        places = [(2.3 * i - 8.05, 2.3 * j - 8.05) for i in range(8) for j in range(8)]
        speeds = [(rng.random() - 0.5, rng.random() - 0.5) for _ in places]
        circles = [Circle(p, v, radius=1.0) for p, v in zip(places, speeds, strict=True)]
        return Scene(circles, box(-9.2, -9.2, 9.2, 9.2))
    if kind == 'sizes':
        # So many small ones to a large one that the grid has a level for each.
        circles = place(rng, 1, [2.5], 5.7)
        circles += place(rng, 110, [0.12], 5.7, taken=circles)
        circles += place(rng, 3, [0.4], 5.7, locked=True, taken=circles)
        return Scene(circles, regular_polygon(5 + seed % 3, 7.2, rng.random()))
    if kind == 'seams':
        # Sides in pieces of any length, order and direction, some twice; dividers end on them outside and inside.
        walls = [piece for side in tilted for piece in in_pieces(rng, side, 12)]
        inner = [Wall(side.start, (0.9 * side.start[0], 0.9 * side.start[1])) for side in tilted]
        outer = [Wall(w.end, (1.5 * w.end[0], 1.5 * w.end[1])) for w in walls[::5]]
        walls += [*inner, *outer]
        rng.shuffle(walls)
        return Scene(place(rng, 20, [0.7], 10.0), walls)
    raise AssertionError(kind)


def in_pieces(rng, wall, count):
    """Return walls that cover one in pieces of very different lengths, and one piece that overlaps others."""

    def at(share):
        return tuple(a + share * (b - a) for a, b in zip(wall.start, wall.end, strict=True))

    cuts = sorted(10.0 ** (-6.0 * rng.random()) for _ in range(count - 1))
    points = [wall.start, *(at(share) for share in cuts), wall.end]
    pairs = [*itertools.pairwise(points), (points[count // 3], points[-2])]
    return [Wall(*(pair if rng.random() < 0.5 else pair[::-1])) for pair in pairs]


def two_levels(seed):
    """Return a scene of large circles among so many small ones that each get cells of their own."""
    rng = random.Random(f'two levels {seed}')
    circles = place(rng, 5, [2.0, 1.7], 10.0, speed=3.0)
    circles += place(rng, 280, [0.1], 10.0, taken=circles)
    return Scene(circles, box(-10, -10, 10, 10))


def _clear_of(walls, circle):
    """Is the circle further than its radius from points along each wall, closely spaced?"""
    return all(
        math.dist(
            circle.position, [a + k / 50 * (b - a) for a, b in zip(w.start, w.end, strict=True)]
        )
        > 1.5 * circle.radius
        for w in walls
        for k in range(51)
    )
