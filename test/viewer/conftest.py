"""The real viewer, fed by the real node over DDS, and what a test needs to look at it."""

import shutil
import sys
from pathlib import Path

import pytest

# The observer of the node's tests serves here too.
sys.path.insert(0, str(Path(__file__).parents[1] / 'ros'))

from browsing import (
    WIDE,
    drive,
    launch,
    missing_browser,
    wait_for_circles,
    wait_for_values,
    wait_until,
)
from observing import NodeProcess, Observer
from scripting import BrowserScripts, NodeScripts
from viewing import PATIENCE, VIEWER, Stage, address_of, end_all

from circle_bounce_ros.scene_file import load_scene


@pytest.fixture(scope='session')
def stage(domain, tmp_path_factory):
    stage = Stage(tmp_path_factory.mktemp('stage'))
    stage.start_node()
    stage.start_viewer()
    yield stage
    stage.end()


@pytest.fixture(scope='session')
def lone_viewer(domain, tmp_path_factory):
    """Return the address of a viewer in a namespace where there is no node."""
    log = tmp_path_factory.mktemp('lone') / 'log'
    viewer = NodeProcess(log, '-p', 'port:=0', '-r', '__ns:=/alone', program=VIEWER)
    try:
        yield address_of(viewer)
    finally:
        end_all([viewer])


@pytest.fixture(scope='session')
def shared_observer(domain):
    observer = Observer(domain)
    yield observer
    observer.close()


@pytest.fixture
def observer(shared_observer):
    """Return an observer that knows the services already, and that hears nothing yet."""
    yield shared_observer
    for subscription in list(shared_observer.node.subscriptions):
        shared_observer.node.destroy_subscription(subscription)


@pytest.fixture
def play(stage, observer):
    """Return a function that makes the shared node show a scene from its first instant."""

    def play(scene='lesson', paused=False):
        observer.wait_for_node()
        assert observer.set_together(scene=str(scene), seed=-1, within=PATIENCE).successful
        assert observer.set(time_scale=1.0).successful
        observer.pause(paused)
        observer.reset()

    return play


@pytest.fixture(scope='session')
def browser():
    if missing_browser():
        pytest.skip(missing_browser())
    with drive() as playwright:
        browser = launch(playwright)
        yield browser
        browser.close()


@pytest.fixture(scope='session')
def scripts(request, tmp_path_factory):
    """Return the page's modules, to be called."""
    if shutil.which('node'):
        scripts = NodeScripts(tmp_path_factory.mktemp('page'))
        yield scripts
        scripts.close()
        return
    browser, address = (request.getfixturevalue(name) for name in ('browser', 'lone_viewer'))
    page = browser.new_page()
    page.goto(address)
    yield BrowserScripts(page)
    page.close()


@pytest.fixture
def open_page(browser):
    """Return a function that opens an address and returns the page; an error in it fails the test."""
    contexts, errors = [], []

    def open_page(address, size=WIDE, **options):
        contexts.append(browser.new_context(viewport=size, **({'color_scheme': 'dark'} | options)))
        page = contexts[-1].new_page()
        page.on('pageerror', lambda error: errors.append(str(error)))
        page.goto(address)
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert errors == []


@pytest.fixture
def show(stage, play, open_page):
    """Return a function that plays a scene and returns a page that shows it."""

    def show(scene='lesson', count=1, paused=False, **options):
        play(scene, paused)
        page = open_page(stage.address, **options)
        wait_for_circles(page, count)
        # The scene's own circles, also where another one has as many, and what stands still in it.
        wait_until(page, f'bounce.world.scene === {Path(scene).stem!r}')
        if count < 1000:
            still = load_scene(str(scene))
            locked = sum(circle.locked for circle in still.circles)
            wait_until(
                page,
                f'bounce.world.locked.length === {locked} && bounce.world.walls.length === {len(still.walls)}',
            )
        wait_for_values(page, scene=Path(scene).stem, paused=str(paused).lower(), time_scale='1.0')
        return page

    return show


@pytest.fixture
def lesson_page(show):
    return show()


@pytest.fixture
def many(tmp_path):
    """Return the path of a scene of 10,000 circles that pass through each other: cheap for any engine."""
    path = tmp_path / 'many.yaml'
    path.write_text(
        'moving_circles_collide: false\n'
        'groups:\n'
        '  - {count: 10000, radius: 0.01, speed: {maxwell: 0.02}, region: {min: [-3, -2], max: [3, 2]}}\n'
        'walls:\n  - box: {min: [-3, -2], max: [3, 2]}\n'
    )
    return path
