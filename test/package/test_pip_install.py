"""What pip installs is complete, in a source tree that is not there any more or that is edited."""

import sys
from pathlib import Path

import pytest
from installs import PACKAGE, ROOT, packages_here, run

WHERE = """
from circle_bounce_ros.installation import share_directory
print(share_directory())
"""


@pytest.fixture(scope='module', params=['normal', 'editable'])
def installed(request, builder, source_tree, tmp_path_factory):
    """Return how it was installed, the new environment, and the tree it was installed from."""
    folder = tmp_path_factory.mktemp(request.param) / 'environment'
    run(sys.executable, '-m', 'venv', '--without-pip', folder)
    python = folder / 'bin/python'
    # The packages that it needs, and setuptools of the builder, without downloads.
    borrowed = [*builder.parent.glob('lib/python3*/site-packages'), *packages_here()]
    site_packages = next(folder.glob('lib/python3*/site-packages'))
    (site_packages / 'borrowed.pth').write_text(''.join(f'{path}\n' for path in borrowed))
    how = ['--editable'] if request.param == 'editable' else []
    run(
        *[builder / 'python', '-m', 'pip', '--python', python, 'install', '--quiet'],
        *['--no-index', '--no-deps', '--no-build-isolation', '--disable-pip-version-check'],
        *[*how, source_tree],
    )
    return request.param, folder, source_tree


def test_the_package_finds_its_files(installed, tmp_path):
    how, folder, tree = installed
    share = Path(run(folder / 'bin/python', '-c', WHERE, cwd=tmp_path).strip())
    assert share == (tree if how == 'editable' else folder / 'share' / PACKAGE)
    config = {path.relative_to(ROOT) for path in (ROOT / 'config').rglob('*')}
    assert config == {path.relative_to(share) for path in (share / 'config').rglob('*')}


def test_the_console_scripts_are_on_the_path(installed, tmp_path):
    _, folder, tree = installed
    assert (folder / 'bin/bounce_node').is_file()
    assert (folder / 'bin/bounce_viewer').is_file()
    run(folder / 'bin/bounce_check', tree / 'config/scenes/lesson.yaml', cwd=tmp_path)


def test_the_files_of_the_live_page_are_installed(installed, tmp_path):
    _, folder, _ = installed
    where = 'import circle_bounce_ros.viewer as v; print(v.__path__[0])'
    page = Path(run(folder / 'bin/python', '-c', where, cwd=tmp_path).strip()) / 'page'
    here = ROOT / PACKAGE / 'viewer/page'
    assert (here / 'index.html').is_file()
    assert {path.name for path in page.iterdir()} == {path.name for path in here.iterdir()}


def test_ament_finds_a_package_that_pip_has_installed(installed):
    how, folder, _ = installed
    marker = folder / 'share/ament_index/resource_index/packages' / PACKAGE
    # colcon would write a missing one by itself, so this is where it shows; an editable install has no data files.
    assert marker.is_file() == (how == 'normal')


def test_a_source_tree_finds_its_files(source_tree):
    assert run(sys.executable, '-c', WHERE, cwd=source_tree).strip() == str(source_tree)
