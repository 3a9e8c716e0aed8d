"""For everybody: keyboard, screen reader, contrast, less motion, a phone."""

import pytest
from browsing import PHONE, press, wait_until


def test_every_button_and_choice_has_a_name_and_can_be_reached_with_the_keyboard(lesson_page):
    page = lesson_page
    page.evaluate('bounce.selectNext(1)')
    controls = page.evaluate(
        """
        () => [...document.querySelectorAll('button, input, select')].filter((e) => e.checkVisibility())
          .map((e) => [e.id || e.outerHTML, e.type !== 'radio' || e.checked,
            e.getAttribute('aria-label') || [...(e.labels || [])].map((l) => l.innerText).join() || e.innerText])
        """
    )
    assert [control for control, _, name in controls if not name.strip()] == []
    wanted = {control for control, takes_focus, _ in controls if takes_focus}
    assert len(wanted) > 15
    page.locator('.skip').focus()
    reached = set()
    for _ in range(len(wanted) + 20):
        page.keyboard.press('Tab')
        reached.add(page.evaluate('document.activeElement.id || document.activeElement.outerHTML'))
    assert wanted - reached == set()
    assert 'bodies' in reached


def test_the_picture_is_told_in_words(lesson_page):
    page = lesson_page
    page.evaluate('bounce.selectNext(1)')
    label = "document.getElementById('bodies').getAttribute('aria-label')"
    wait_until(page, f"{label}.includes('Circle 0 is selected')")
    said = page.evaluate(label)
    assert 'Scene lesson: 1 moving and 1 locked circles, 4 walls, running.' in said
    page.locator('#pause').click()
    wait_until(page, f"{label}.includes('paused')")
    # What changes by itself or is an answer is announced.
    for name in ('answer', 'notice', 'warning'):
        assert page.locator(f'#{name}').get_attribute('role') == 'status'


@pytest.mark.parametrize('scheme', ['dark', 'light'])
def test_words_stand_out_from_their_background(show, scheme):
    page = show(color_scheme=scheme, reduced_motion='reduce')  # no colour is on its way to another
    page.evaluate('bounce.selectNext(1)')
    wait_until(page, "!document.getElementById('lesson').hidden")
    pairs = page.evaluate(
        """
        () => [...document.querySelectorAll('h1, h2, h3, dt, dd, p, label, button, output, .badge, small, kbd')]
          .filter((e) => e.checkVisibility() && e.innerText.trim() && !e.matches('.only-read'))
          .map((e) => {
            let ground = e;
            const see = (x) => getComputedStyle(x).backgroundColor;
            while (ground && /, 0\\)|transparent/.test(see(ground))) ground = ground.parentElement;
            return [e.innerText, getComputedStyle(e).color, see(ground)];
          })
        """
    )
    assert len(pairs) > 30
    for words, colour, ground in pairs:
        # WCAG 2.1, level AA.
        assert contrast(colour, ground) >= 4.5, (words, colour, ground)


def contrast(*colours):
    """Return the contrast of two CSS colours, by WCAG 2.1."""
    light = []
    for colour in colours:
        assert colour.startswith(('rgb', 'color(srgb')), colour
        numbers = colour[colour.index('(') + 1 : -1].replace('srgb', '').split('/')[0]
        values = [float(part) for part in numbers.replace(',', ' ').split()[:3]]
        values = [value / 255 if colour.startswith('rgb') else value for value in values]
        linear = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in values]
        light.append(0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2])
    return (max(light) + 0.05) / (min(light) + 0.05)


@pytest.mark.parametrize('scheme', ['dark', 'light'])
def test_what_is_written_over_the_picture_stands_out_from_it(scripts, scheme):
    look = scripts.evaluate("async (load) => (await load('colours.js')).LOOKS")[scheme]

    def css(code):
        return f'rgb({", ".join(str(int(code[i : i + 2], 16)) for i in (1, 3, 5))})'

    for name in ('text', 'dim', 'before', 'after', 'normal', 'across', 'along'):
        assert contrast(css(look[name]), css(look['background'])) >= 4.5, name


def test_the_system_chooses_the_look_and_a_choice_of_ones_own_is_kept(show):
    page = show(color_scheme='light')
    assert page.evaluate('document.documentElement.dataset.theme') == 'light'
    press(page, 'd')
    page.reload()
    wait_until(page, 'bounce.drawTimes.length > 0')
    assert page.evaluate('document.documentElement.dataset.theme') == 'dark'
    assert page.evaluate('getComputedStyle(document.body).colorScheme') == 'dark'


def test_who_wants_less_motion_gets_no_trails_and_no_transitions(show):
    assert show().evaluate('bounce.looks.trail') > 0
    page = show(reduced_motion='reduce')
    assert page.evaluate('bounce.looks.trail') == 0
    duration = "getComputedStyle(document.getElementById('answer')).transitionDuration"
    assert page.evaluate(duration) == '0s'


def test_a_phone_shows_it_all_without_scrolling_sideways(show):
    page = show(size=PHONE)
    assert page.evaluate('document.documentElement.scrollWidth') <= PHONE['width']
    box = page.locator('#stage').bounding_box()
    assert box['height'] > 200
    assert box['y'] + box['height'] < PHONE['height']
    # Large enough for a finger: 24 CSS pixels, WCAG 2.2, level AA.
    small = page.evaluate(
        """() => [...document.querySelectorAll('button, select, input:not([type=checkbox]):not([type=radio])')]
        .filter((e) => e.checkVisibility() && e.getBoundingClientRect().height < 24).map((e) => e.id)"""
    )
    assert small == []
