"""
Odd scenes, plain against compiled: the same bits, for any cut of time, with every index checked.

To be run with NUMBA_BOUNDSCHECK=1 and a cache folder of its own, because compiled code is kept.
"""

import argparse
import random
import sys
import time
import traceback
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / 'kernel'))

import numpy as np
from random_scenes import KINDS, random_scene

from circle_bounce_ros.kernel import (
    Circle,
    EndlessContactsError,
    Scene,
    SceneError,
    Simulation,
    Wall,
)

OUT = Path(__file__).parents[2] / 'out' / 'fuzz'

# Steps: beside a heavy circle a light one gets so fast that some scenes would go on for minutes.
MOST_WORK = 10_000


def odd_scene(rng):
    """Return a random scene: scaled, moved, with odd masses, speeds and radii, and how long to run it."""
    kind = rng.choice(KINDS)
    scene = random_scene(kind, rng.randrange(10**6))
    scale = 10.0 ** rng.choice([0, 0, 0, -3, 3, -8, 8])
    dx, dy = (rng.choice([0, 0, 1, -37.5]) * scale for _ in 'xy')
    slow = 10.0 ** rng.choice([0, 0, 0, -6, 4]) * scale

    def at(point):
        return point[0] * scale + dx, point[1] * scale + dy

    circles = []
    for circle in scene.circles:
        way = 1.0 if circle.locked else rng.random()
        speed = 0.0 if way < 0.1 else slow
        circles.append(
            Circle(
                at(circle.position),
                (circle.velocity[0] * speed, circle.velocity[1] * (0.0 if way < 0.2 else speed)),
                radius=circle.radius * scale * rng.choice([1, 1, 1, 0.5, 0.1]),
                mass=circle.mass * 10.0 ** rng.choice([0, 0, 0, 6, -6]),
                locked=circle.locked,
            )
        )
    walls = [Wall(at(wall.start), at(wall.end)) for wall in scene.walls]
    until = (0.02 if kind == 'fast' else 8.0) * scale / slow
    return Scene(circles, walls, scene.moving_circles_collide), 0.3 * until * rng.random()


def run(scene, cuts, *, compiled):
    """Return whether a run came to its end within MOST_WORK, and all that can be seen of it, as bytes."""
    simulation = Simulation(scene, compiled=compiled, record_contacts=True)
    end, work = 'ok', 0
    try:
        for cut, at_most in cuts:
            while work <= MOST_WORK and not simulation.advance_to(cut, at_most=at_most):
                work += at_most
    except EndlessContactsError as error:
        end = str(error)
    log = simulation.drain_contacts()
    state = (simulation.positions.tobytes(), simulation.velocities.tobytes(), log.tobytes())
    return work <= MOST_WORK, (end, simulation.time, simulation.contact_count, *state)


def check(seed):
    """Compare one scene both ways and cut in two ways; return whether there was such a scene."""
    rng = random.Random(f'engine {seed}')
    try:
        scene, until = odd_scene(rng)
    except SceneError:
        return False
    times = [*sorted(until * rng.random() for _ in range(5)), until]
    cuts = [(time, rng.choice([1, 7, 1000, MOST_WORK])) for time in times]
    finished, plain = run(scene, cuts, compiled=False)
    assert run(scene, cuts, compiled=True) == (finished, plain), 'plain and compiled differ'
    whole_finished, whole = run(scene, [(until, MOST_WORK)], compiled=True)
    assert not (finished and whole_finished) or whole == plain, 'cut and whole differ'
    assert np.isfinite(np.frombuffer(plain[3])).all(), 'a position is not finite'
    return True


def keep(seed, fault):
    """Say what failed, and leave it in out/fuzz with the scene."""
    path = OUT / f'engine-{seed}'
    again = f'make fuzz ARGS="--target engine --seed {seed}"'
    print(f'engine: FAILED, scene in {path}, again with: {again}\n{fault}', flush=True)
    OUT.mkdir(parents=True, exist_ok=True)
    scene, until = odd_scene(random.Random(f'engine {seed}'))
    path.write_text(f'{fault}\nuntil {until!r} s\n{scene!r}\n')


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--seconds', type=float, default=0.0)
    parser.add_argument('--seed', type=int, required=True)
    chosen = parser.parse_args()
    end, seed, scenes, failed = time.monotonic() + chosen.seconds, chosen.seed, 0, 0
    while True:
        try:
            scenes += check(seed)
        except Exception:  # whatever it is, it is what is looked for
            failed += 1
            keep(seed, traceback.format_exc())
        seed += 1
        if time.monotonic() >= end or failed > 20:
            break
    print(f'engine: {scenes} scenes, {failed} failed', flush=True)
    return int(failed > 0)


if __name__ == '__main__':
    sys.exit(main())
