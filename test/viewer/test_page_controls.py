"""Buttons and keys change the node; what it refuses is shown in its own words."""

import pytest
from browsing import press, text_of, wait_for_circles, wait_for_values, wait_until
from diagnostic_msgs.msg import DiagnosticArray
from observing import nanoseconds, scene_times
from sensor_msgs.msg import TimeReference


def seconds_of(message):
    return nanoseconds(message.time_ref)


def standing(times):
    """Return the scene time (ns) at which the last five ticks stand still, as a set; None while it goes on."""
    last = {seconds_of(message) for message in times[-5:]}
    return last if len(times) >= 5 and len(last) == 1 else None


@pytest.mark.parametrize('by', ['mouse', 'keyboard'])
def test_pause_step_and_reset_do_what_they_say(lesson_page, observer, by):
    page = lesson_page
    times = observer.listen(TimeReference, 'time')

    def do(name, key):
        if by == 'mouse':
            page.locator(f'#{name}').click()
        else:
            press(page, key)

    do('pause', ' ')
    wait_for_values(page, paused='true')
    (stands,) = observer.spin_until(lambda: standing(times), 'it stands still')
    do('step', '.')
    (further,) = observer.spin_until(lambda: (standing(times) or {stands}) - {stands}, 'a step')
    # One period of 60 Hz, to the nanosecond below.
    assert further - stands in (16666666, 16666667)
    do('reset', 'r')
    observer.spin_until(lambda: standing(times) == {0}, 'the first instant')
    do('pause', ' ')
    observer.spin_until(lambda: seconds_of(times[-1]) > 0, 'it goes on')
    wait_until(page, "document.getElementById('state').textContent === 'running'")


def test_the_speed_is_the_nodes_parameter(lesson_page, observer):
    page = lesson_page
    press(page, '[')
    wait_for_values(page, time_scale='0.5')
    assert text_of(page, 'speed-value') == '0.5 ×'
    press(page, ']')
    wait_for_values(page, time_scale='1.0')
    page.locator('#speed').fill('7')
    wait_for_values(page, time_scale='2.0')
    # The scene really runs at that speed, by the stamps of its messages.
    times = observer.listen(TimeReference, 'time')
    ticks = sorted(scene_times(observer.collect(times, 60)).items())
    speeds = [
        (now - then) / (last - first)
        for (first, then), (last, now) in zip(ticks, ticks[10:], strict=False)
    ]
    # On a busy machine a tick that is later than 0.1 s drops what is beyond that, but never adds.
    assert max(speeds) == pytest.approx(2.0, rel=0.1)
    (first, then), (last, now) = ticks[0], ticks[-1]
    assert (now - then) / (last - first) < 2.001


SPEED_AND_REPORTS = """
async (load) => {
  const { PlaybackSpeed, SPEEDS } = await load('playback.js');
  const sent = [];
  const playback = new PlaybackSpeed((message) => { sent.push(message.value); return true; });
  const said = (value) => { playback.hear(value, performance.now()); return playback.chosen; };
  const log = {};
  playback.choose(SPEEDS.indexOf(2));
  log.beforeItIsAsked = said(1);
  while (!sent.length) await new Promise(requestAnimationFrame);
  log.beforeItIsDone = said(1);
  log.done = said(2);
  playback.followContact(0, { time: 0.01 });
  log.slow = said(2);
  said(0.24);
  playback.followContact(1e9, { time: 100 });
  log.afterwards = said(0.24);
  log.doneAgain = said(2);
  log.byOthers = said(5);
  return { ...log, sent };
}
"""


def test_a_report_from_before_a_change_does_not_undo_it(scripts):
    log = scripts.evaluate(SPEED_AND_REPORTS)
    assert log == {
        'beforeItIsAsked': 2,
        'beforeItIsDone': 2,
        'done': 2,
        'slow': 2,
        'afterwards': 2,
        'doneAgain': 2,
        'byOthers': 5,
        'sent': [2, 0.24, 2],
    }


LOST_END = """
async (load) => {
  const { PlaybackSpeed } = await load('playback.js');
  const sent = [];
  const playback = new PlaybackSpeed((message) => { sent.push(message.value); return true; });
  const said = (value) => { playback.hear(value, performance.now()); return playback.chosen; };
  said(2);
  playback.followContact(0, { time: 0.01 });
  said(0.24);
  playback.forget();
  const log = { back: said(0.24), beforeItIsDone: said(0.24), done: said(2), byOthers: said(0.24) };
  return { ...log, sent };
}
"""


def test_slow_motion_that_was_cut_off_is_not_taken_for_the_speed_chosen(scripts):
    log = scripts.evaluate(LOST_END)
    assert log == {
        'back': 2,
        'beforeItIsDone': 2,
        'done': 2,
        'byOthers': 0.24,
        'sent': [0.24, 2],
    }


def test_the_chooser_loads_scenes_and_shows_refusals_in_words(lesson_page, observer):
    page = lesson_page
    times = observer.listen(TimeReference, 'time')
    page.locator('#scene').select_option('mixed')
    observer.spin_until(lambda: times and times[-1].source == 'mixed', 'the other scene')
    wait_for_circles(page, 160)
    page.locator('#seed').fill('7')
    page.get_by_role('button', name='Load').click()
    wait_for_values(page, seed='7')
    page.locator('#scene').select_option('…')
    page.locator('#own').fill('no/such.yaml')
    page.get_by_role('button', name='Load').click()
    wait_until(page, "document.getElementById('answer').textContent.startsWith('Refused')")
    assert 'no/such.yaml' in text_of(page, 'answer')
    assert page.locator('#answer').is_visible()
    assert page.evaluate('bounce.node.values.scene') == 'mixed'
    page.get_by_role('button', name='Step').click()
    wait_until(page, "document.getElementById('answer').textContent.includes('pause')")


def test_a_file_is_loaded_by_its_path_and_the_chooser_says_so(lesson_page, tmp_path):
    page = lesson_page
    path = tmp_path / 'own.yaml'
    path.write_text('circles:\n  - {position: [0, 0], velocity: [1, 0], radius: 0.1}\n')
    page.locator('#scene').select_option('…')
    page.locator('#own').fill(str(path))
    page.keyboard.press('Enter')
    wait_for_values(page, scene='own')
    assert page.locator('#scene').input_value() == '…'
    assert page.locator('#own').is_visible()


def ask_and_wait(page, ask, answer):
    """Do something that is answered in these words, over the same connection as before."""
    page.evaluate("document.getElementById('answer').textContent = ''")
    ask()
    wait_until(page, f"document.getElementById('answer').textContent.includes({answer!r})")


@pytest.mark.parametrize(
    ('field', 'text'), [('seed', '-5'), ('seed', '1e20'), ('own', 'a\u200bb.yaml')]
)
def test_what_cannot_be_asked_for_is_refused_at_its_field_and_the_connection_stays(
    lesson_page, field, text
):
    page = lesson_page
    page.evaluate('window.socket = bounce.link.socket')
    scene = page.locator('#scene')
    if field == 'own':
        scene.select_option('…')
    page.locator(f'#{field}').fill(text)
    # To choose another scene loads it, too.
    if field == 'own':
        page.get_by_role('button', name='Load').click()
    else:
        scene.select_option('mixed')
    assert page.evaluate(f"document.getElementById('{field}').validationMessage") != ''
    assert page.evaluate('document.activeElement.id') == field
    ask_and_wait(page, page.get_by_role('button', name='Step').click, 'pause')
    assert page.evaluate('window.socket === bounce.link.socket')


def test_the_longest_path_is_refused_by_the_node(lesson_page):
    page = lesson_page
    page.locator('#scene').select_option('…')
    page.locator('#own').fill('球' * 400)
    ask_and_wait(page, page.get_by_role('button', name='Load').click, 'Refused')
    assert page.locator('#own').is_visible(), 'to be mended'


def test_after_a_refusal_the_chooser_shows_the_nodes_scene_and_the_refused_one_can_be_chosen_again(
    show,
):
    page = show('mixed', 160)
    # As where the node is of another version than the viewer.
    page.evaluate("document.getElementById('scene').add(new Option('gone', 'gone'))")
    for _ in range(2):
        ask_and_wait(page, lambda: page.locator('#scene').select_option('gone'), 'Refused')
        assert page.locator('#scene').input_value() == 'mixed'


# Each key, and what is true when it has done its work. In this order they leave nothing switched on.
KEYS = [
    ('k', 'bounce.world.rowOf(bounce.story.circle) === 0'),
    ('k', 'bounce.world.rowOf(bounce.story.circle) === 1'),
    ('j', 'bounce.world.rowOf(bounce.story.circle) === 0'),
    ('m', "document.getElementById('slow').checked"),
    ('m', "!document.getElementById('slow').checked"),
    ('b', "document.getElementById('squares').checked"),
    ('b', "!document.getElementById('squares').checked"),
    ('z', "document.getElementById('follow').checked && !bounce.view.camera.fits"),
    ('f', "!document.getElementById('follow').checked && bounce.view.camera.fits"),
    ('t', 'bounce.looks.trail === 0.5'),
    ('t', 'bounce.looks.trail === 1'),
    ('t', 'bounce.looks.trail === 2'),
    ('t', 'bounce.looks.trail === 4'),
    ('t', 'bounce.looks.trail === 0'),
    ('c', "bounce.looks.mode === 'identity'"),
    ('c', "bounce.looks.mode === 'speed'"),
    ('d', "document.documentElement.dataset.theme === 'light'"),
    ('d', "document.documentElement.dataset.theme === 'dark'"),
    ('Escape', 'bounce.story.circle === -1'),
    ('s', "document.activeElement.id === 'scene'"),
    ('?', "document.getElementById('keys').open"),
]


def test_there_is_a_key_for_everything_and_the_help_lists_them(show):
    page = show('mixed', 160, paused=True)
    assert page.evaluate('bounce.looks.trail') == 0
    for key, done in KEYS:
        press(page, key)
        wait_until(page, done, f'{key}: {done}')
    listed = page.locator('#key-list kbd').all_inner_texts()
    used = {key.upper() for key, _ in KEYS if len(key) == 1} | {'Space', '.', 'R', '[', ']', 'Esc'}
    assert used <= set(listed)
    page.locator('#keys-on').uncheck()
    page.get_by_role('button', name='Close', exact=True).click()
    press(page, 'k')
    press(page, 'd')
    assert page.evaluate('bounce.story.circle') == -1, 'keys are off'
    assert page.evaluate('document.documentElement.dataset.theme') == 'dark'


READ_NUMBERS = """
() => {
  const names = ['factor', 'contacts', 'energy', 'circles', 'static'];
  const texts = names.map((name) => [name, document.getElementById(`n-${name}`).innerText]);
  return { values: bounce.node.values, ...Object.fromEntries(texts) };
}
"""


def test_numbers_are_those_of_the_topics(show, observer):
    page = show('mixed', 160)
    reports = observer.listen(DiagnosticArray, '/diagnostics')
    times = observer.listen(TimeReference, 'time')
    # From now on this subscriber hears whatever the page hears.
    observer.collect(reports, 1)
    first = page.evaluate('bounce.node.values["contacts/s"]')
    wait_until(page, f'bounce.node.values["contacts/s"] !== "{first}"', 'another report')
    shown = page.evaluate(READ_NUMBERS)

    def heard():
        return [
            {item.key: item.value for item in status.values}
            for message in reports
            for status in message.status
        ]

    observer.spin_until(lambda: shown['values'] in heard(), 'the report that is shown')
    values = shown['values']
    # JavaScript and Python round a half to different sides.
    contacts = float(shown['contacts'].replace(',', ''))
    assert contacts == pytest.approx(float(values['contacts/s']), abs=0.5)
    factor = float(shown['factor'].removesuffix(' ×'))
    assert factor == pytest.approx(float(values['real-time factor']), abs=0.005 + 1e-9)
    error = float(values['energy error'])
    number, _, power = shown['energy'].partition(' · 10')
    power = power.translate(str.maketrans('⁻⁰¹²³⁴⁵⁶⁷⁸⁹', '-0123456789'))
    assert float(f'{number}e{power or 0}'.replace('−', '-')) == pytest.approx(error, rel=0.06)
    assert (shown['circles'], shown['static']) == ('160', '5, 4')

    press(page, ' ')
    wait_for_values(page, paused='true')
    (stands,) = observer.spin_until(lambda: standing(times), 'it stands still')
    milliseconds = stands // 10**6
    text = f'{milliseconds // 60000:02}:{milliseconds // 1000 % 60:02}.{milliseconds % 1000:03}'
    wait_until(page, f"document.getElementById('n-time').innerText === '{text}'")
    wait_until(page, "Number(document.getElementById('n-frames').innerText) > 0")
