"""
Measure the live page with software rendering: `python benchmarks/viewer.py [SECONDS]`.

Frames drawn per second, the time from a message's stamp to its drawing, and what the viewer needs of a core, for
scenes of 1,000, 10,000 and 100,000 circles; then ten clients without a browser; then a page that stalls.
"""

import asyncio
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'test/ros'))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'test/viewer'))

from viewing import Stage, connected, drive, launch, missing_browser

from circle_bounce_ros.viewer.cloud import stamp_of

CLIENTS = 10
TICKS = os.sysconf('SC_CLK_TCK')

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
    const [s, ns] = app.world.cloud.stamp.split('.');
    lags.push(Date.now() - (Number(s) * 1000 + Number(ns) / 1e6));
    if (performance.now() - began > seconds * 1000) {
      bounce.afterDraw = null;
      resolve([lags.length / ((performance.now() - began) / 1000), lags]);
    }
  };
})
"""


def cpu_of(pid):
    fields = Path(f'/proc/{pid}/stat').read_text().rpartition(')')[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def p95(values):
    return statistics.quantiles(values, n=20)[-1] if len(values) > 1 else values[0]


def show(stage, folder, count):
    path = folder / f'{count}.yaml'
    path.write_text(SCENE.format(count=count, radius=0.6 / count**0.5))
    stage.start_node('-p', f'scene:={path}')
    return path


def measure_page(stage, browser, seconds, count):
    page = browser.new_context(viewport={'width': 1280, 'height': 800}).new_page()
    page.goto(stage.address)
    while page.evaluate('bounce.world.count') != count or page.evaluate('bounce.received') < 30:
        page.wait_for_timeout(100)
    page.evaluate('bounce.setTrail(0)')
    page.wait_for_timeout(3000)
    cpu, began = cpu_of(stage.viewer.process.pid), time.monotonic()
    rate, lags = page.evaluate(MEASURE, seconds)
    share = (cpu_of(stage.viewer.process.pid) - cpu) / (time.monotonic() - began)
    print(
        f'{count:7,} circles: {rate:5.1f} frames/s, stamp to draw p95 {p95(lags):4.0f} ms, '
        f'viewer {share:4.0%} of a core',
        flush=True,
    )
    if count == 10000:
        stall(page, seconds)
    page.context.close()


def stall(page, seconds):
    """Let every frame take 300 ms: the lag must stay small."""
    page.evaluate(
        """() => { const draw = bounce.picture.draw.bind(bounce.picture);
        bounce.picture.draw = (view) => { draw(view); const t = performance.now() + 300;
          while (performance.now() < t) { /* busy */ } }; }"""
    )
    page.wait_for_timeout(2000)
    _, lags = page.evaluate(MEASURE, 2 * seconds)
    half = len(lags) // 2
    print(
        f'        a page that stalls 300 ms a frame lags {max(lags[:half]):.0f} ms at most in the first half '
        f'and {max(lags[half:]):.0f} ms in the second',
        flush=True,
    )


async def measure_clients(stage, seconds):
    async def look():
        async with connected(stage.address) as page:
            _, number, *_ = await page.frame()
            await page.say(type='ack', frame=number)
            began, lags = time.monotonic(), []
            while time.monotonic() < began + seconds:
                _, number, _, bodies = await page.frame()
                lags.append((time.time_ns() - stamp_of(bodies)) / 1e6)
                await page.say(type='ack', frame=number)
            return len(lags) / (time.monotonic() - began), lags

    cpu, began = cpu_of(stage.viewer.process.pid), time.monotonic()
    results = await asyncio.gather(*(look() for _ in range(CLIENTS)))
    share = (cpu_of(stage.viewer.process.pid) - cpu) / (time.monotonic() - began)
    lags = [lag for _, lags in results for lag in lags]
    print(
        f'{CLIENTS} clients at 10,000 circles: {min(rate for rate, _ in results):.1f} frames/s or more each, '
        f'stamp to arrival p95 {p95(lags):.0f} ms, viewer {share:.0%} of a core',
        flush=True,
    )


def main():
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 5.0
    if missing_browser():
        sys.exit(missing_browser())
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    print(f'load before: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores', flush=True)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for count in (1000, 10000, 100000):
            stage = Stage(folder)
            show(stage, folder, count)
            stage.start_viewer()
            try:
                with drive() as playwright:
                    browser = launch(playwright)
                    measure_page(stage, browser, seconds, count)
                    browser.close()
                if count == 10000:
                    asyncio.run(measure_clients(stage, seconds))
            finally:
                stage.end()


if __name__ == '__main__':
    main()
