"""Photograph the live page for the documents: `.venv/bin/python tools/screenshots.py [FOLDER]`."""

import os
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'test/ros'))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'test/viewer'))

from browsing import (
    PHONE,
    WIDE,
    drive,
    launch,
    press,
    restart_paused,
    step,
    wait_for_values,
    wait_until,
)
from viewing import Stage

PICTURES = Path(__file__).resolve().parents[1] / 'docs' / 'pictures'


def at_a_contact(page):
    """Stop just after a contact with a locked circle."""
    restart_paused(page)
    press(page, 'k')
    while not page.evaluate('bounce.story.last !== null && bounce.story.last.kind === 1'):
        step(page)
    for _ in range(3):
        step(page)


def before_a_contact(page):
    """Stop where squares overlap already and circles do not touch yet."""
    restart_paused(page)
    press(page, 'k')
    press(page, 'b')
    while page.evaluate('bounce.story.next.kind !== "locked" || bounce.story.next.time > 0.06'):
        step(page)


def after(seconds):
    def act(page):
        wait_until(page, f'bounce.world.seconds > {seconds}')

    return act


SHOTS = [
    ('viewer-dark', 'lesson', WIDE, 'dark', at_a_contact),
    ('viewer-approach', 'lesson', WIDE, 'light', before_a_contact),
    ('viewer-gas', 'gas', WIDE, 'light', after(6)),
    ('viewer-pegboard', 'pegboard', WIDE, 'dark', after(6)),
    ('viewer-phone', 'mixed', PHONE, 'dark', after(5)),
]
ANSWERED = "getComputedStyle(document.getElementById('answer')).opacity === '0'"


def main() -> None:
    into = Path(sys.argv[1]) if len(sys.argv) > 1 else PICTURES
    into.mkdir(parents=True, exist_ok=True)
    # Else a node that runs already would be heard.
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
    os.environ.setdefault('ROS_DOMAIN_ID', str(1 + os.getpid() % 100))
    with tempfile.TemporaryDirectory() as folder, drive() as playwright:
        browser = launch(playwright)
        for name, scene, size, scheme, act in SHOTS:
            stage = Stage(Path(folder))
            stage.start_node('-p', f'scene:={scene}')
            stage.start_viewer()
            try:
                page = browser.new_page(viewport=size, color_scheme=scheme)
                page.goto(stage.address)
                wait_until(page, 'bounce.drawTimes.length > 5')
                wait_for_values(page, scene=scene)
                act(page)
                page.mouse.move(0, 0)
                page.evaluate('document.activeElement.blur()')
                wait_until(page, ANSWERED)
                page.screenshot(path=into / f'{name}.png')
                page.close()
            finally:
                stage.end()
            print(into / f'{name}.png', flush=True)
        browser.close()


if __name__ == '__main__':
    main()
