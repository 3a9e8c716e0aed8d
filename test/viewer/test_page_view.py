"""Mouse, fingers and keys move the view; the picture follows to the pixel."""

import pytest
from browsing import pause, press, wait_until
from picture import Picture

# From config/scenes/lesson.yaml: the locked circle.
RED = (0.3, 0.15, 0.7)


@pytest.fixture
def page(show):
    page = show(paused=True)
    page.evaluate('bounce.looks.setTrail(0)')
    return page


def red_on(page):
    """Return where the locked circle is on the picture, by its pixels: centre and radius, px."""
    picture = Picture(page)
    return picture.find(*picture.place(*RED[:2]), RED[2] * picture.scale)


def drag(page, start, end):
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(*end, steps=5)
    page.mouse.up()


def place_on_page(page, x, y):
    """Return where a place of the picture is in the window, CSS pixels."""
    box = page.locator('#bodies').bounding_box()
    return box['x'] + x, box['y'] + y


def test_dragging_moves_the_picture_by_as_much_as_the_mouse(page):
    x, y, radius = red_on(page)
    start = place_on_page(page, 100, 100)
    drag(page, start, (start[0] + 60, start[1] + 35))
    wait_until(page, '!bounce.isDirty')
    # Whole pixels of a disc of more than 100 px are counted: its middle is good to far less than half of one.
    assert red_on(page) == pytest.approx((x + 60, y + 35, radius), abs=0.5)
    assert page.evaluate('bounce.story.circle') == -1, 'a drag is no click'


def test_the_wheel_zooms_and_what_is_under_the_mouse_stays(page):
    x, y, radius = red_on(page)
    page.mouse.move(*place_on_page(page, x, y))
    page.mouse.wheel(0, 120)
    wait_until(page, 'bounce.view.camera.fits === false && !bounce.isDirty')
    nx, ny, smaller = red_on(page)
    assert (nx, ny) == pytest.approx((x, y), abs=0.5)
    assert smaller < 0.9 * radius
    page.mouse.wheel(0, -120)
    wait_until(page, f'bounce.view.camera.scale * {RED[2]} > {smaller} * 1.1 && !bounce.isDirty')
    assert red_on(page) == pytest.approx((x, y, radius), abs=0.5)


def test_two_fingers_zoom_and_what_is_under_them_stays_under_them(show):
    page = show(paused=True, has_touch=True)
    page.evaluate('bounce.looks.setTrail(0)')
    fingers = page.context.new_cdp_session(page)

    def touch(kind, *places):
        points = [{'x': x, 'y': y, 'id': number} for number, (x, y) in enumerate(places)]
        fingers.send('Input.dispatchTouchEvent', {'type': kind, 'touchPoints': points})

    def under(place):
        box = page.locator('#bodies').bounding_box()
        x, y = place[0] - box['x'], place[1] - box['y']
        return page.evaluate(f'bounce.view.camera.toWorld({x}, {y})')

    first, second = (400.0, 300.0), (600.0, 400.0)
    scale = page.evaluate('bounce.view.camera.scale')
    held = under(first), under(second)
    touch('touchStart', first, second)
    # Apart along the line between them, and aside with it: factor 1.5, then by 30 and 20 px.
    for share in (0.25, 0.5, 0.75, 1.0):
        a = (400 - 50 * share + 30 * share, 300 - 25 * share + 20 * share)
        b = (600 + 50 * share + 30 * share, 400 + 25 * share + 20 * share)
        touch('touchMove', a, b)
    wait_until(page, f'bounce.view.camera.scale > {scale} * 1.49')
    touch('touchEnd')
    assert page.evaluate('bounce.view.camera.scale') == pytest.approx(1.5 * scale, rel=0.01)
    # A finger is reported in whole or fractional pixels, one after the other: within two of them.
    for place, point in ((a, held[0]), (b, held[1])):
        assert under(place) == pytest.approx(point, abs=2 / scale)
    assert page.evaluate('bounce.story.circle') == -1, 'two fingers are no click'


def test_a_double_click_and_the_buttons_fit_the_scene_again(page):
    whole = red_on(page)
    for again in (
        lambda: page.locator('#bodies').dblclick(position={'x': 40, 'y': 40}),
        lambda: page.locator('#fit').click(),
        lambda: press(page, 'f'),
    ):
        page.locator('#zoom-out').click()
        press(page, 'ArrowLeft')
        wait_until(page, 'bounce.view.camera.fits === false && !bounce.isDirty')
        assert red_on(page)[2] < 0.9 * whole[2]
        again()
        wait_until(page, 'bounce.view.camera.fits && !bounce.isDirty')
        assert red_on(page) == pytest.approx(whole, abs=0.01)


def test_arrow_keys_and_plus_and_minus_move_the_view(page):
    x, y, radius = red_on(page)
    press(page, 'ArrowLeft')
    press(page, 'ArrowUp')
    assert red_on(page) == pytest.approx((x + 60, y + 60, radius), abs=0.5)
    press(page, 'ArrowRight')
    press(page, 'ArrowDown')
    assert red_on(page) == pytest.approx((x, y, radius), abs=0.5)
    press(page, '-')
    assert red_on(page)[2] == pytest.approx(radius / 1.3, abs=0.5)
    press(page, '+')
    assert red_on(page)[2] == pytest.approx(radius, abs=0.5)


def test_a_window_of_another_size_shows_the_whole_scene(page):
    for width, height in ((1000, 700), (800, 900)):
        page.set_viewport_size({'width': width, 'height': height})
        wait_until(
            page, 'bounce.view.camera.width === document.getElementById("stage").clientWidth'
        )
        picture = Picture(page)
        for corner in ((-2, -1.5), (2, 1.5)):
            x, y = picture.place(*corner)
            assert 0 < x < picture.pixels.shape[1]
            assert 0 < y < picture.pixels.shape[0]


def test_following_keeps_the_selected_circle_in_the_middle(show):
    page = show()
    press(page, 'z')
    wait_until(page, 'bounce.story.now !== null && bounce.view.camera.fits === false')
    pause(page)
    wait_until(page, 'bounce.story.now.x === bounce.view.camera.x && !bounce.isDirty')
    picture = Picture(page)
    height, width, _ = picture.pixels.shape
    radius = 0.2 * picture.scale
    assert radius > 0.06 * min(height, width), 'it comes close'
    # A rim of a wall or of the red circle may be in the same window: only the middle is looked at.
    assert picture.pixels[height // 2, width // 2] == pytest.approx([0, 158, 115], abs=3)
    press(page, 'z')
    wait_until(page, 'bounce.view.camera.fits && !bounce.isDirty')
