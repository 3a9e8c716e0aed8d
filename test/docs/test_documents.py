"""The documents do not rot: what they name exists, what they show runs, what they quote is drawn."""

import doctest
import inspect
import re
from pathlib import Path

import pytest
from png import numbers_of

from circle_bounce_ros import kernel

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / 'docs'
DOCUMENTS = sorted(DOCS.glob('*.md'))
IMAGES = sorted((DOCS / 'images').glob('*.png'))
PHYSICS = (DOCS / 'physics.md').read_text()
LESSON = ['1.1', '1.2', '1.3', '1.4', '1.5', '2.1', '2.2', '2.3', '2.4']

every_document = pytest.mark.parametrize('document', DOCUMENTS, ids=lambda path: path.name)


def rows_of_physics():
    """Return (equation or '-', function) of each row of the table."""
    return re.findall(r'^\| (\d\.\d|-) \|.*\| `(\w+)` \|', PHYSICS, re.MULTILINE)


def equations_cited(text):
    """Return the equations that a docstring cites: `eq. 1.2-1.5` is four of them."""
    cited = set()
    for first, last in re.findall(r'eq\. (\d\.\d)(?:-(\d\.\d))?', text):
        cited |= {number for number in LESSON if first <= number <= (last or first)}
    return cited


def images_shown(document):
    return re.findall(r'!\[[^\]]+\]\(([^)]+)\)', document.read_text())


def captions_of(document):
    """Return image and text of each caption that quotes the numbers of its drawing."""
    pattern = r'!\[[^\]]+\]\(([^)]+)\)\n\n\*Drawn: (.*?)\*(?:\n\n|\Z)'
    return re.findall(pattern, document.read_text(), re.DOTALL)


def anchors_of(document):
    """Return the anchors that GitHub gives to headings."""
    titles = re.findall(r'^#+ (.+)$', document.read_text(), re.MULTILINE)
    anchors = [re.sub(r'[^\w\- ]', '', title.lower()).replace(' ', '-') for title in titles]
    assert len(set(anchors)) == len(anchors), 'two headings alike: their anchors get numbers'
    return anchors


def test_the_physics_leads_from_every_equation_of_the_lesson_to_a_function():
    assert sorted({equation for equation, _ in rows_of_physics()} - {'-'}) == LESSON


@pytest.mark.parametrize(('equation', 'function'), rows_of_physics())
def test_a_function_of_the_physics_exists_and_cites_its_equation(equation, function):
    assert function in kernel.__all__
    cited = equations_cited(inspect.getdoc(getattr(kernel, function)))
    assert equation == '-' or equation in cited


def test_the_physics_shows_every_formula_of_the_kernel():
    modules = {
        f'{kernel.__name__}.{name}' for name in ('contact', 'reflection', 'impact', 'invariants')
    }
    public = {name: getattr(kernel, name) for name in kernel.__all__}
    formulas = [
        name
        for name, thing in public.items()
        if inspect.isfunction(thing) and thing.__module__ in modules
    ]
    assert len(formulas) >= 13
    assert [name for name in formulas if f'`{name}`' not in PHYSICS] == []


@every_document
def test_the_code_in_a_document_gives_what_it_says(document):
    """All blocks of a document are one session, as a reader would type them."""
    blocks = re.findall(r'^```pycon\n(.*?)^```$', document.read_text(), re.MULTILINE | re.DOTALL)
    session = doctest.DocTestParser().get_doctest(
        '\n'.join(blocks), {}, document.name, str(document), 0
    )
    said = []
    failed, tried = doctest.DocTestRunner(verbose=False).run(session, out=said.append)
    assert tried >= len(blocks)
    assert failed == 0, ''.join(said)


@every_document
def test_a_document_has_no_other_python_that_nobody_runs(document):
    assert '```py\n' not in document.read_text()
    assert '```python' not in document.read_text()


@every_document
def test_links_of_a_document_lead_somewhere(document):
    links = re.findall(r'(?<!!)\[[^\]]+\]\(([^)]+)\)', document.read_text())
    for link in links:
        if link.startswith('http'):
            continue
        path, _, anchor = link.partition('#')
        target = document.parent / path if path else document
        assert target.exists(), link
        assert not anchor or anchor in anchors_of(target), link


@every_document
def test_images_of_a_document_exist_and_say_what_they_show(document):
    text = document.read_text()
    assert text.count('![') == len(images_shown(document))  # each has a text for who cannot see it
    for image in images_shown(document):
        assert (document.parent / image).is_file(), image


def test_every_drawing_is_shown_or_is_one_of_a_packaged_scene():
    shown = {Path(image).name for document in DOCUMENTS for image in images_shown(document)}
    scenes = {f'scene_{path.stem}.png' for path in (ROOT / 'config' / 'scenes').glob('*.yaml')}
    assert {path.name for path in IMAGES} - shown - scenes == set()
    assert scenes - {path.name for path in IMAGES} == {'scene_lesson.png'}  # that is lesson.png


def test_every_drawing_that_is_shown_has_its_numbers_below_it_somewhere():
    captioned = {image for document in DOCUMENTS for image, _ in captions_of(document)}
    shown = {image for document in DOCUMENTS for image in images_shown(document)}
    drawn = {f'images/{path.name}' for path in IMAGES}
    assert shown & drawn - captioned == set()


@pytest.mark.parametrize('image', IMAGES, ids=lambda path: path.name)
def test_an_image_is_small(image):
    assert image.stat().st_size < 150_000


@every_document
def test_numbers_below_an_image_are_those_it_was_drawn_from(document):
    for image, caption in captions_of(document):
        drawn = numbers_of(document.parent / image)
        quoted = list(re.finditer(r' = (-?\d+(?:\.(\d+))?)', caption))
        assert quoted
        for number in quoted:
            before = caption[: number.start()].replace('\n', ' ')
            names = [name for name in drawn if re.search(rf'(^|\W){re.escape(name)}$', before)]
            assert names, f'{image}: {before}'
            # Rounded to as many digits as the text has.
            places = len(number[2] or '')
            assert round(drawn[max(names, key=len)], places) == float(number[1]), before


@every_document
def test_tests_and_files_that_a_document_names_exist(document):
    text = document.read_text()
    sources = {path.name: path.read_text() for path in (ROOT / 'test').rglob('test_*.py')}
    tests = set(re.findall(r'def (test_\w+)', '\n'.join(sources.values())))
    for name in re.findall(r'\b(test_\w+)\b(?!\.py)', text):
        assert name in tests, name
    files = {
        path.name
        for folder in (
            'circle_bounce_ros',
            'test',
            'benchmarks',
            'launch',
            'tools',
            'examples',
            'docs',
        )
        for path in (ROOT / folder).rglob('*.py')
    }
    for name in re.findall(r'\b([\w.]+\.py)\b', text):
        assert name in files, name
