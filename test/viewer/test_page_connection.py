"""What is missing is said, what comes back is shown, and only its own page may look."""

import functools
import http.server
import threading

import pytest
from browsing import PATIENCE, press, text_of, wait_for_circles, wait_for_values, wait_until
from sensor_msgs.msg import PointCloud2


def wait_for_notice(page, words):
    wait_until(
        page,
        f"!document.getElementById('notice').hidden && "
        f"document.getElementById('notice').innerText.includes({words!r})",
    )


def wait_for_no_notice(page):
    wait_until(page, "document.getElementById('notice').hidden")


# Every frame takes this long to draw, and the page does nothing else meanwhile.
STALL = """
() => {
  const draw = bounce.picture.draw.bind(bounce.picture);
  window.lags = [];
  window.passed = [];
  let last = performance.now();
  bounce.picture.draw = (view) => {
    draw(view);
    const until = performance.now() + 300;
    while (performance.now() < until) { /* busy */ }
    window.passed.push(performance.now() - last);
    last = performance.now();
    const [seconds, nanoseconds] = bounce.world.cloud.stamp.split('.').map(Number);
    window.lags.push(Date.now() - seconds * 1000 - nanoseconds / 1e6);
  };
}
"""


def test_a_page_that_stalls_misses_frames_and_does_not_lag_more_and_more(show, many):
    page = show(many, 10000)
    first = page.evaluate('bounce.received')
    page.evaluate(STALL)
    lags, passed = wait_until(page, 'window.lags.length >= 12 && [window.lags, window.passed]')
    # At 60 Hz some 18 frames come while one is drawn, and on a busy machine fewer.
    assert page.evaluate('bounce.received') - first > 3 * 12
    # A frame waits for two others at most: the one that is drawn, and the one that is on its way. Pushed blindly,
    # twelve frames are of the first fifth of a second, and wait for all before them. How little it can be,
    # benchmarks/viewer.py measures.
    for number in range(6, 12):
        assert lags[number] < sum(passed[number - 2 : number + 1]) + 500


def test_the_page_comes_back_when_the_viewer_does(show, stage):
    page = show()
    page.evaluate('bounce.selectNext(1)')
    assert stage.viewer.end() == 0
    wait_for_notice(page, 'No connection to the viewer')
    wait_until(page, "document.getElementById('n-frames').innerText === '0'")
    assert text_of(page, 'state') == 'no viewer'
    # What is asked for meanwhile is refused in words.
    page.locator('#reset').click()
    wait_until(page, "document.getElementById('answer').innerText.includes('no connection')")
    page.locator('#scene').select_option('gas')
    assert page.locator('#scene').input_value() == 'lesson'
    stage.start_viewer()
    wait_for_no_notice(page)
    first = page.evaluate('bounce.received')
    wait_until(page, f'bounce.received > {first}')
    # What was selected still is, for the new viewer too.
    count = page.evaluate('bounce.story.count')
    wait_until(page, f'bounce.story.count > {count}', 'a contact of the selected circle')
    wait_until(page, "document.getElementById('state').innerText === 'running'")


STAY_SLOW = """
bounce.playback.isSlow && bounce.node.values.time_scale === '0.12' && (bounce.playback.followContact = () => {}, true)
"""


def test_slow_motion_ends_although_the_viewer_ended_within_it(show, stage):
    page = show()
    press(page, 'm')
    wait_until(page, STAY_SLOW)
    assert stage.viewer.end() == 0
    wait_for_notice(page, 'No connection to the viewer')
    stage.start_viewer()
    wait_for_no_notice(page)
    wait_for_values(page, time_scale='1.0')
    wait_until(page, "document.getElementById('speed-value').innerText === '1 ×'")


def test_where_nothing_is_published_the_page_says_so_and_what_to_do(lone_viewer, open_page):
    page = open_page(lone_viewer)
    wait_for_notice(page, 'Nobody publishes /alone/bodies')
    assert 'Nothing is published' in text_of(page, 'notice')
    assert page.locator('#notice').is_visible()
    assert text_of(page, 'state') == 'silent'
    page.locator('#step').click()
    wait_until(page, "document.getElementById('answer').innerText.includes('is the node running')")


UNREADABLE = """
() => { const world = bounce.world; const read = world.setBodies.bind(world);
  world.setBodies = (...all) => { read(...all); throw new Error('bodies: field x is missing'); }; }
"""


def test_what_cannot_be_read_is_said_in_words(lesson_page):
    lesson_page.evaluate(UNREADABLE)
    wait_for_notice(lesson_page, 'bodies: field x is missing')
    assert text_of(lesson_page, 'state') == 'unreadable'


SAY_FAULTS = """
(faults) => {
  bounce.hear({ type: 'status', publishers: ['/bounce'], faults });
  const notice = document.getElementById('notice');
  return !notice.hidden && notice.innerText;
}
"""


def test_what_the_viewer_could_not_read_is_said_until_it_can(lesson_page):
    said = lesson_page.evaluate(SAY_FAULTS, {'contacts': 'cloud: nx must be finite'})
    assert 'contacts: cloud: nx must be finite' in said
    assert lesson_page.evaluate(SAY_FAULTS, {}) is False


def test_two_simulations_on_one_topic_are_named_as_long_as_there_are_two(lesson_page, observer):
    second = observer.node.create_publisher(PointCloud2, 'bodies', 10)
    try:
        wait_for_notice(lesson_page, '/bounce and /observer publish /bodies')
    finally:
        observer.node.destroy_publisher(second)
    wait_until(lesson_page, "document.getElementById('notice').hidden", 'one simulation left')


OPEN_SOCKET = """
(url) => new Promise((resolve) => {
  const socket = new WebSocket(url);
  socket.onopen = () => resolve('open');
  socket.onerror = () => resolve('refused');
})
"""


class QuietHandler(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


@pytest.fixture
def elsewhere(tmp_path):
    """Return the address of another site on this machine."""
    (tmp_path / 'index.html').write_text('<title>elsewhere</title>')
    handler = functools.partial(QuietHandler, directory=str(tmp_path))
    with http.server.ThreadingHTTPServer(('127.0.0.1', 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield f'http://127.0.0.1:{server.server_address[1]}/'
        server.shutdown()
        thread.join(PATIENCE)


def test_a_page_of_another_origin_gets_nothing(stage, browser, elsewhere):
    viewer = stage.address
    context = browser.new_context()
    try:
        page = context.new_page()
        page.goto(elsewhere)
        socket = viewer.replace('http', 'ws') + '/socket'
        assert page.evaluate(OPEN_SOCKET, socket) == 'refused'
        assert page.evaluate(f"fetch('{viewer}/').then(() => 'got', () => 'refused')") == 'refused'
        # The same from the viewer's own page, so that it is the origin that made the difference.
        page.goto(viewer)
        assert page.evaluate(OPEN_SOCKET, socket) == 'open'
        # A foreign name that points to this machine.
        port = viewer.rpartition(':')[2]
        response = page.goto(f'http://rebound.example.com:{port}/')
        assert response.status == 403
    finally:
        context.close()


def test_a_node_that_ended_is_missed_and_one_that_starts_is_seen(show, stage):
    page = show()
    assert page.locator('#notice').is_hidden()
    assert stage.node.end() == 0
    wait_for_notice(page, 'Nobody publishes /bodies')
    stage.start_node('-p', 'scene:=mixed')
    wait_for_no_notice(page)
    wait_for_circles(page, 160)
    wait_until(page, 'bounce.world.locked.length === 5', 'the locked circles of the other scene')
    wait_for_values(page, scene='mixed')
    # The buttons reach the new node.
    wait_until(
        page,
        "(bounce.node.pause(), document.getElementById('answer').innerText.length > 0) && bounce.node.paused",
    )
