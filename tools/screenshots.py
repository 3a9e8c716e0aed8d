"""Photograph the live page for the documents: `.venv/bin/python tools/screenshots.py [FOLDER]`."""

import os
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'test/ros'))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'test/viewer'))

from viewing import Stage, drive, launch

PICTURES = Path(__file__).resolve().parents[1] / 'docs' / 'pictures'
DESK = {'width': 1280, 'height': 800}
PHONE = {'width': 390, 'height': 844}

LET_IT_RUN = 'new Promise((resolve) => setTimeout(resolve, {}))'
# Just after a contact with a locked circle, and stopped there.
STOP_AT_CONTACT = """
new Promise((resolve) => {
  bounce.selectNext(1);
  const look = setInterval(() => {
    if (bounce.story.freshness < 0.93 || bounce.story.last.kind !== 1) return;
    clearInterval(look);
    bounce.ask({ type: 'pause', paused: true });
    setTimeout(resolve, 4500);
  }, 5);
})
"""

# Squares overlap by then, circles do not touch yet.
STEP_TO_THE_RED_ONE = """
new Promise((resolve) => {
  bounce.ask({ type: 'pause', paused: true });
  bounce.ask({ type: 'reset' });
  const look = setInterval(() => {
    const { next } = bounce.story;
    if (!bounce.paused || !next || bounce.world.seconds > 1) return;
    if (next.kind !== 'locked' || next.time > 0.06) {
      bounce.ask({ type: 'step' });
      return;
    }
    clearInterval(look);
    setTimeout(resolve, 4500);
  }, 150);
})
"""

SHOTS = [
    ('viewer-dark', 'lesson', DESK, 'dark', [STOP_AT_CONTACT]),
    (
        'viewer-approach',
        'lesson',
        DESK,
        'light',
        [
            "bounce.selectNext(1); document.getElementById('squares').click()",
            STEP_TO_THE_RED_ONE,
        ],
    ),
    ('viewer-gas', 'gas', DESK, 'light', [LET_IT_RUN.format(6000)]),
    ('viewer-pegboard', 'pegboard', DESK, 'dark', [LET_IT_RUN.format(6000)]),
    ('viewer-phone', 'mixed', PHONE, 'dark', [LET_IT_RUN.format(5000)]),
]


def main() -> None:
    into = Path(sys.argv[1]) if len(sys.argv) > 1 else PICTURES
    into.mkdir(parents=True, exist_ok=True)
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    with tempfile.TemporaryDirectory() as folder, drive() as playwright:
        browser = launch(playwright)
        for name, scene, size, scheme, acts in SHOTS:
            stage = Stage(Path(folder))
            stage.start_node('-p', f'scene:={scene}')
            stage.start_viewer()
            try:
                page = browser.new_page(viewport=size, color_scheme=scheme)
                page.goto(stage.address)
                while page.evaluate('bounce.drawTimes.length < 5 || !bounce.values.scene'):
                    page.wait_for_timeout(100)
                for act in acts:
                    page.evaluate(act)
                page.screenshot(path=into / f'{name}.png')
                page.close()
            finally:
                stage.end()
            print(into / f'{name}.png', flush=True)
        browser.close()


if __name__ == '__main__':
    main()
