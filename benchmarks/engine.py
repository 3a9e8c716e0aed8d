"""
The engine beside its peers: `python -m benchmarks.engine [--short] [--into FOLDER]`.

Numbers go into engine.json of docs/benchmarks; `benchmarks.report` makes tables and figures of them.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from benchmarks import accuracy, itself, machine, results, scenes
from benchmarks.contestants import Billiards, Box2D, Contestant, Ours, Pymunk
from benchmarks.measure import LONG, SHORT, Pace, frames_of, in_turn, one_turn, ratios
from benchmarks.rows import row
from circle_bounce_ros.kernel import Scene, compile_ahead

Row = dict[str, Any]
Maker = Callable[[Scene], Contestant]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        '--short', action='store_true', help='small and quick, to see that it runs'
    )
    parser.add_argument('--into', type=Path, default=results.FOLDER)
    arguments = parser.parse_args()
    pace = SHORT if arguments.short else LONG
    path = results.save('engine', run(pace), arguments.into)
    print(f'written to {path}')


def run(pace: Pace) -> dict[str, Any]:
    """Return all that there is to know."""
    compile_ahead()
    settings: dict[str, str] = {}
    rows = [
        *gases(pace, settings),
        *among_locked(pace, settings),
        *itself.rows(pace),
    ]
    growth, cost = itself.cost_against_count(pace)
    return {
        'machine': machine.describe(),
        'settings': settings,
        'rows': rows + growth,
        'cost': cost,
        'speed': ratio_against_speed(pace),
        'accuracy': accuracies(pace, settings),
    }


# ------------------------------------------------------------------ beside peers


def gases(pace: Pace, settings: dict[str, str]) -> list[Row]:
    """Return the lines of equal disks at packing 0.3."""
    wanted = {100: (3, 5, 13, 20), 1_000: (6, 10, 23, 40), 10_000: (11, 20, None, None)}
    rows = []
    for count in (n for n in (100, 1_000, 10_000) if n <= pace.largest):
        scene = scenes.gas(count)
        least, aim, least_10, aim_10 = wanted[count]
        name = f'gas, {count:,} equal disks'
        rivals: list[tuple[Maker, float | None, float | None]] = [
            (best_pymunk(scene, pace), least, aim),
            (best_pymunk(scene, pace, batch=True), None, None),
            (Box2D, None, None),
        ]
        if least_10 is not None:
            rivals.append((best_pymunk(scene, pace, substeps=10), least_10, aim_10))
        rows += beside(name, scene, rivals, pace, settings)
        if count == (1_000 if pace.largest >= 1_000 else 100):
            rows += beside_billiards(name, scene, pace, settings)
    return rows


def among_locked(pace: Pace, settings: dict[str, str]) -> list[Row]:
    """Return the lines of mixed sizes, of balls that pass through each other, and of one ball."""
    count = min(1_000, pace.largest)
    scene = scenes.mixed(count)
    name = f'{count:,} disks, radii and masses 2:1, 20 locked circles'
    pymunk = best_pymunk(scene, pace)
    rows = beside(name, scene, [(pymunk, 7, 10)], pace, settings)
    for count, least, aim in ((100, 4, 8), (1_000, 30, 50), (10_000, 200, 300)):
        if count <= pace.largest:
            scene = scenes.ghosts(count)
            name = f'{count:,} balls that pass through each other, 100 locked circles'
            rivals = [
                (best_pymunk(scene, pace), least, aim),
                (best_pymunk(scene, pace, batch=True), None, None),
            ]
            rows += beside(name, scene, rivals, pace, settings)
    scene = scenes.one_ball()
    rows += beside('one ball, one locked circle, a box', scene, [(Pymunk, 1.5, 3)], pace, settings)
    return rows


def best_pymunk(scene: Scene, pace: Pace, **options: Any) -> Maker:
    """Return pymunk with the spatial index that is the faster one for a scene."""
    makers = [partial(Pymunk, spatial_hash=choice, **options) for choice in (False, True)]
    costs = in_turn([frames_of(maker(scene)) for maker in makers], SHORT)
    return makers[0] if min(costs[0]) <= min(costs[1]) else makers[1]


def beside(
    name: str,
    scene: Scene,
    rivals: Sequence[tuple[Maker, float | None, float | None]],
    pace: Pace,
    settings: dict[str, str],
) -> list[Row]:
    """Return a line for each rival: its CPU time per frame by ours, on the same scene in one run."""
    everybody: list[Contestant] = [Ours(scene), *(maker(scene) for maker, _, _ in rivals)]
    settings.update({one.name: one.settings for one in everybody})
    costs = in_turn([frames_of(one) for one in everybody], pace)
    return [
        row(
            name,
            rival.name,
            ratios(cost, costs[0]),
            'x faster',
            least,
            aim,
            note=per_frame(cost, costs[0]),
        )
        for rival, cost, (_, least, aim) in zip(everybody[1:], costs[1:], rivals, strict=True)
    ]


def per_frame(theirs: Sequence[float], ours: Sequence[float]) -> str:
    """Return both costs in words."""
    return f'{1e3 * min(ours):.3g} against {1e3 * min(theirs):.3g} ms a frame at best'


def beside_billiards(name: str, scene: Scene, pace: Pace, settings: dict[str, str]) -> list[Row]:
    """Return the line of the exact peer, whose frames take seconds."""
    ours, theirs = Ours(scene), Billiards(scene)
    settings[theirs.name] = theirs.settings
    pairs = []
    for _ in range(min(3, pace.rounds)):
        cost = one_turn(frames_of(theirs), 0.0)
        pairs.append(cost / one_turn(frames_of(ours), pace.block))
    return [row(name, theirs.name, pairs, 'x faster', 1_000)]


def ratio_against_speed(pace: Pace) -> list[dict[str, float]]:
    """Return how the comparison with pymunk depends on how fast the disks of a gas are."""
    found = []
    for speed in (0.03, 0.1, scenes.SPEED, 0.3, 1.0):
        scene = scenes.gas(min(1_000, pace.largest), speed=speed)
        makers = [Ours, *(best_pymunk(scene, pace, batch=batch) for batch in (False, True))]
        costs = in_turn([frames_of(maker(scene)) for maker in makers], pace)
        each, batch = (sorted(ratios(cost, costs[0])) for cost in costs[1:])
        middle = pace.rounds // 2
        found.append({'speed': speed, 'pymunk': each[middle], 'batch': batch[middle]})
    return found


# ------------------------------------------------------------------ accuracy


def accuracies(pace: Pace, settings: dict[str, str]) -> list[dict[str, Any]]:
    """Return what everybody makes of the same gas, slow for a minute and fast for 30 frames."""
    count = min(1_000, pace.largest)
    share = 1 if pace is LONG else 60
    runs = [
        ('slow: 1/6 radius a frame, 60 s', scenes.gas(count), 3_600 // share, 10),
        # Box2D needs seconds for such a frame.
        (
            'fast: 100 radii a frame, 30 frames',
            scenes.gas(count, speed=100.0),
            30 // min(share, 15),
            1,
        ),
    ]
    found = []
    for name, scene, frames, every in runs:
        makers: list[Maker] = [Ours, Pymunk, partial(Pymunk, substeps=10), Box2D]
        for maker in makers:
            contestant = maker(scene)
            settings[contestant.name] = contestant.settings
            judged = accuracy.judge(contestant, frames, every)
            found.append({'run': name, 'name': contestant.name, **judged})
            print(found[-1], flush=True)
    return found


if __name__ == '__main__':
    main()
