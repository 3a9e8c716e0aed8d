"""
Measure the live page with software rendering: `python -m benchmarks.viewer [--seconds S] [--rounds N]`.

Frames drawn per second, the time from a message's stamp to its drawing, and what the viewer needs of a core, for
scenes of 1,000, 10,000 and 100,000 circles; ten clients without a browser; a page that stalls; and how soon after
the node's start the lesson is seen. Writes docs/benchmarks/viewer.json and the tables in docs/viewer.md.
"""

from __future__ import annotations

import argparse
import asyncio
import os
import statistics
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

# The tests know how to start it all and how to look at it.
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'test/ros'))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'test/viewer'))

from browsing import WIDE, drive, launch, missing_browser, wait_until
from viewing import Stage, connected

from benchmarks import machine, results
from benchmarks.wording import measured_on, number
from circle_bounce_ros.kernel import compile_ahead
from circle_bounce_ros.viewer.cloud import stamp_of
from tools.run import PROGRAMS

DOCUMENT = results.FOLDER.parent / 'viewer.md'
BEGIN = '<!-- made by `make bench-viewer` -->\n'
END = '<!-- end of what `make bench-viewer` makes -->\n'

COUNTS = {'few': 1000, 'many': 10000, 'most': 100000}  # moving circles
CLIENTS = 10
STALL = 300  # ms
WARM_UP = 3.0  # s: what is compiled and opened at first is not measured
TICKS = os.sysconf('SC_CLK_TCK')

# What is wanted, by key of a line: (at least or at most, limit).
WANTED = {
    'few rate': ('at least', 40.0),
    'many rate': ('at least', 15.0),
    'many lag': ('at most', 150.0),
    'many viewer': ('at most', 15.0),
    'clients rate': ('at least', 55.0),
    'clients viewer': ('at most', 30.0),
    'stall first half': ('at most', 600.0),
    'stall second half': ('at most', 600.0),
    'start first frame': ('at most', 5.0),
}

SCENE = """
moving_circles_collide: false
groups:
  - {{count: {count}, radius: {radius}, speed: {{maxwell: 0.1}}, region: {{min: [-3, -2], max: [3, 2]}}}}
walls:
  - box: {{min: [-3, -2], max: [3, 2]}}
"""

MEASURE = """
(seconds) => new Promise((resolve) => {
  const lags = [];
  const began = performance.now();
  bounce.afterDraw = (app) => {
    const [s, ns] = app.world.cloud.stamp.split('.').map(Number);
    lags.push(Date.now() - (s * 1000 + ns / 1e6));
    if (performance.now() - began > seconds * 1000) {
      bounce.afterDraw = null;
      resolve([lags.length / ((performance.now() - began) / 1000), lags]);
    }
  };
})
"""
SLOW_DOWN = """
(stall) => {
  const draw = bounce.picture.draw.bind(bounce.picture);
  bounce.picture.draw = (view) => {
    draw(view);
    const until = performance.now() + stall;
    while (performance.now() < until) { /* busy */ }
  };
}
"""


class Share:
    """What a process takes of a core, %, from when this is made."""

    def __init__(self, pid: int) -> None:
        self._pid = pid
        self._began, self._then = time.monotonic(), self._cpu()

    def _cpu(self) -> float:
        fields = Path(f'/proc/{self._pid}/stat').read_text().rpartition(')')[2].split()
        return (int(fields[11]) + int(fields[12])) / TICKS

    def value(self) -> float:
        return 100 * (self._cpu() - self._then) / (time.monotonic() - self._began)


def p95(values: list[float]) -> float:
    return statistics.quantiles(values, n=20)[-1] if len(values) > 1 else values[0]


def measure_start(folder: Path, browser: Any) -> dict[str, float]:
    """Return the time from the node's start, and the viewer's with it, to the first drawn frame of the lesson, s."""
    page = browser.new_context(viewport=WIDE).new_page()
    stage = Stage(folder)
    began = time.monotonic()
    stage.start_node()
    try:
        stage.start_viewer()
        page.goto(stage.address)
        wait_until(page, 'bounce.drawTimes.length > 0')
        passed = time.monotonic() - began
    finally:
        stage.end()
    page.context.close()
    return {'first frame': passed}


@contextmanager
def watched(stage: Stage, browser: Any, seconds: float, count: int) -> Iterator[Any]:
    """`with watched(...) as page`: a page that draws so many circles, warmed up."""
    page = browser.new_context(viewport=WIDE).new_page()
    page.goto(stage.address)
    wait_until(page, f'bounce.world.count === {count} && bounce.received >= 30')
    page.evaluate('bounce.looks.setTrail(0)')
    page.wait_for_timeout(1000 * min(WARM_UP, seconds))
    yield page
    page.context.close()


def measure_page(stage: Stage, page: Any, seconds: float) -> dict[str, float]:
    """Return rate (Hz), lag (ms, p95), viewer (% of a core)."""
    share = Share(stage.viewer.process.pid)
    rate, lags = page.evaluate(MEASURE, seconds)
    return {'rate': rate, 'lag': p95(lags), 'viewer': share.value()}


def measure_stall(page: Any, seconds: float) -> dict[str, float]:
    """Return the largest lag of a page that stalls, in the first and in the second half of the time, ms."""
    page.evaluate(SLOW_DOWN, STALL)
    page.wait_for_timeout(1000 * min(WARM_UP, seconds))
    _, lags = page.evaluate(MEASURE, 2 * seconds)
    half = len(lags) // 2
    return {'first half': max(lags[:half]), 'second half': max(lags[half:])}


async def measure_clients(stage: Stage, seconds: float) -> dict[str, float]:
    """Return rate (Hz, of the slowest client), lag (ms, p95), viewer (% of a core)."""

    async def look() -> tuple[float, list[float]]:
        async with connected(stage.address) as page:
            _, frame, *_ = await page.frame()
            await page.say(type='ack', frame=frame)
            began, lags = time.monotonic(), []
            while time.monotonic() < began + seconds:
                _, frame, _, bodies = await page.frame()
                lags.append((time.time_ns() - stamp_of(bodies)) / 1e6)
                await page.say(type='ack', frame=frame)
            return len(lags) / (time.monotonic() - began), lags

    share = Share(stage.viewer.process.pid)
    found = await asyncio.gather(*(look() for _ in range(CLIENTS)))
    lags = [lag for _, some in found for lag in some]
    return {'rate': min(rate for rate, _ in found), 'lag': p95(lags), 'viewer': share.value()}


def one_round(seconds: float, counts: dict[str, int]) -> dict[str, dict[str, float]]:
    """Return what was measured with few, many and most circles, with `clients`, of a `stall` and of the `start`."""
    found: dict[str, dict[str, float]] = {}
    with tempfile.TemporaryDirectory() as name, drive() as playwright:
        browser = launch(playwright)
        found['start'] = measure_start(Path(name), browser)
        browser.close()
    for part, count in counts.items():
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            path = folder / 'scene.yaml'
            path.write_text(SCENE.format(count=count, radius=0.6 / count**0.5))
            stage = Stage(folder)
            stage.start_node('-p', f'scene:={path}')
            stage.start_viewer()
            try:
                with drive() as playwright:
                    browser = launch(playwright)
                    with watched(stage, browser, seconds, count) as page:
                        found[part] = measure_page(stage, page, seconds)
                        if part == 'many':
                            found['stall'] = measure_stall(page, seconds)
                    browser.close()
                if part == 'many':
                    found['clients'] = asyncio.run(measure_clients(stage, seconds))
            finally:
                stage.end()
    for part, values in found.items():
        print(part, {key: round(value, 1) for key, value in values.items()}, flush=True)
    return found


def medians(rounds: list[dict[str, dict[str, float]]]) -> dict[str, float]:
    """Return the median over the rounds, by `<part> <quantity>`."""
    keys = [(part, key) for part, found in rounds[0].items() for key in found]
    return {
        f'{part} {key}': statistics.median(one[part][key] for one in rounds) for part, key in keys
    }


def table(found: dict[str, Any]) -> str:
    """Return the numbers in words."""
    medians, spread, counts = found['medians'], found['spread'], found['counts']

    def cell(key: str, unit: str) -> str:
        text = f'**{number(medians[key])}**{unit}'
        if key in spread:
            text += f' ({number(spread[key][0])} - {number(spread[key][1])})'
        if key in WANTED:
            word, limit = WANTED[key]
            is_met = medians[key] >= limit if word == 'at least' else medians[key] <= limit
            text += f'; {word} {limit:g} wanted' + ('' if is_met else ': **missed**')
        return text

    lines = [
        f'| {name} | {cell(f"{part} rate", "")} | {cell(f"{part} lag", " ms")} | {cell(f"{part} viewer", " %")} |\n'
        for part, name in [
            *((part, f'{count:,} circles, a browser') for part, count in counts.items()),
            ('clients', f'{CLIENTS} clients at {counts["many"]:,} circles, each'),
        ]
    ]
    stalling = f'a page that stalls {STALL} ms a frame, at {counts["many"]:,} circles: largest lag'
    singles = [
        f'| {name} | {cell(key, unit)} |\n'
        for name, key, unit in [
            (
                "from the node's start to the first drawn frame of the lesson",
                'start first frame',
                ' s',
            ),
            (f'{stalling} in the first {found["seconds"]:g} s', 'stall first half', ' ms'),
            (f'{stalling} in the next {found["seconds"]:g} s', 'stall second half', ' ms'),
        ]
    ]
    return (
        measured_on(found)
        + '| | frames per second | stamp to draw, p95 | viewer, of a core |\n|---|---|---|---|\n'
        + ''.join(lines)
        + '\n| | |\n|---|---|\n'
        + ''.join(singles)
        + f'\nRounds: {found["rounds"]} of {found["seconds"]:g} s each; medians, in brackets the least and the most. '
        'Clients get frames instead of drawing them.\n'
    )


def put_into(document: Path, found: dict[str, Any]) -> None:
    """
    Write the table between its two marks.

    Raises
    ------
    ValueError
        For a document without the marks.

    """
    before, begin, rest = document.read_text().partition(BEGIN)
    _, end, after = rest.partition(END)
    if not (begin and end):
        raise ValueError(f'{document}: must have the lines {BEGIN!r} and {END!r}')
    document.write_text(before + begin + table(found) + end + after)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--seconds', type=float, default=10.0, help='of each measurement')
    parser.add_argument('--rounds', type=int, default=3)
    parser.add_argument(
        '--counts',
        type=int,
        nargs=3,
        default=list(COUNTS.values()),
        help='few, many, most circles',
    )
    parser.add_argument('--folder', type=Path, default=results.FOLDER)
    parser.add_argument('--document', type=Path, default=DOCUMENT)
    arguments = parser.parse_args()
    if missing_browser():
        sys.exit(missing_browser())
    # Else a node that runs already would be heard.
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
    os.environ.setdefault('ROS_DOMAIN_ID', str(1 + os.getpid() % 100))
    # As `make run` starts the node.
    os.environ.update({**PROGRAMS['bounce_node'], **os.environ})
    compile_ahead()
    print(f'load before: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores', flush=True)
    described = machine.describe()
    counts = dict(zip(COUNTS, arguments.counts, strict=True))
    rounds = [one_round(arguments.seconds, counts) for _ in range(arguments.rounds)]
    every = [medians([one]) for one in rounds]
    found = {
        'machine': described,
        'rounds': arguments.rounds,
        'seconds': arguments.seconds,
        'counts': counts,
        'medians': medians(rounds),
        'spread': {
            key: [min(one[key] for one in every), max(one[key] for one in every)]
            for key in every[0]
            if len(every) > 1
        },
    }
    print(f'written to {results.save("viewer", found, arguments.folder)}')
    put_into(arguments.document, found)


if __name__ == '__main__':
    main()
