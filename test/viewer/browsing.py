"""A real browser, and how a test waits for what the page shows."""

import importlib
import importlib.util
import shutil
import time

from circle_bounce_ros.installation import child_environment

PATIENCE = 30.0  # s; only a fault takes that long, and a busy machine draws in software
BROWSERS = ('chromium', 'chromium-browser', 'google-chrome')
FLAGS = [
    '--no-sandbox',
    '--enable-unsafe-swiftshader',
    '--disable-background-networking',
    '--disable-component-update',
    '--disable-sync',
    '--no-first-run',
    '--disable-default-apps',
    # Containers give shared memory of 64 MB, which a picture and DDS fill.
    '--disable-dev-shm-usage',
    # A name that somebody else owns and lets point to this machine.
    '--host-resolver-rules=MAP rebound.example.com 127.0.0.1',
]

WIDE = {'width': 1280, 'height': 800}
HIGH = {'width': 900, 'height': 1000}
PHONE = {'width': 390, 'height': 844}


def find_browser():
    return next((path for name in BROWSERS if (path := shutil.which(name))), None)


def missing_browser():
    """Return why there can be no tests in a browser, empty when there can."""
    if importlib.util.find_spec('playwright') is None:
        return 'Playwright is not installed (pip install playwright)'
    if find_browser() is None:
        return f'no Chromium on the path: none of {", ".join(BROWSERS)} (apt install chromium)'
    return ''


def drive():
    """Return the context manager that makes a Playwright."""
    # Not an import statement: there is no ROS package of it to be declared.
    return importlib.import_module('playwright.sync_api').sync_playwright()


def launch(playwright):
    return playwright.chromium.launch(
        executable_path=find_browser(), args=FLAGS, env=child_environment()
    )


def wait_until(page, condition, what='', within=PATIENCE):
    """Wait for JavaScript to be true: the page's security policy does not let Playwright wait by itself."""
    deadline = time.monotonic() + within
    while not (result := page.evaluate(condition)):
        assert time.monotonic() < deadline, f'not within {within} s: {what or condition}'
        page.wait_for_timeout(30)
    return result


def wait_for_circles(page, count):
    """Wait until the page has drawn frames with so many moving circles."""
    wait_until(page, f'bounce.drawTimes.length > 0 && bounce.world.count === {count}')


def wait_for_values(page, **values):
    """Wait until the page knows that the node has reported these."""
    said = [f'bounce.node.values.{name} === {value!r}' for name, value in values.items()]
    wait_until(page, ' && '.join(said))


def text_of(page, name):
    return page.locator(f'#{name}').inner_text()


def press(page, key):
    """Press a key while the picture has the focus."""
    page.locator('#bodies').focus()
    page.keyboard.press(key)


def pause(page):
    """Pause by the page's own button; the picture then shows what the last message says."""
    page.locator('#pause').click()
    wait_for_values(page, paused='true')


# Each step is asked for when the one before has been drawn.
STEPS = """
async (count) => {
  const until = performance.now() + 30000;
  for (let done = 0; done < count; done += 1) {
    const before = bounce.world.seconds;
    bounce.node.step();
    while (bounce.world.seconds === before || bounce.isDirty) {
      if (performance.now() > until) throw new Error(`${done} of ${count} steps were drawn`);
      await new Promise((then) => setTimeout(then, 1));
    }
  }
}
"""


def step(page, count=1):
    """Take steps, each of them seen on the picture."""
    page.evaluate(STEPS, count)


def restart_paused(page):
    """Show the scene at its first instant."""
    pause(page)
    page.locator('#reset').click()
    wait_until(page, 'bounce.world.seconds === 0 && !bounce.isDirty')
