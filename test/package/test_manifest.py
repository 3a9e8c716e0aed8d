"""package.xml, setup.py and CHANGELOG.rst agree with each other and with the code."""

import ast
import re
import sys
from xml.etree import ElementTree

import pytest
from installs import PACKAGE, ROOT

# Names of rosdep keys where they are not the names that the code imports.
KEYS = {
    'aiohttp': 'python3-aiohttp',
    'numpy': 'python3-numpy',
    'yaml': 'python3-yaml',
    'jsonschema': 'python3-jsonschema',
    'pytest': 'python3-pytest',
    'hypothesis': 'python3-hypothesis',
    'matplotlib': 'python3-matplotlib',
    'PIL': 'python3-pil',
    'tqdm': 'python3-tqdm',
}
# Names of distributions on PyPI where they are not the names that the code imports.
DISTRIBUTIONS = {'PyYAML': 'yaml'}
# Used where they are there: extras of pip. There are no rosdep keys of them for Ubuntu 24.04.
OPTIONAL = {'numba', 'rosbags', 'mcap', 'pyarrow', 'dask', 'distributed'}
# Only for the commands that work without ROS.
FOR_COMMANDS = {'python3-matplotlib', 'python3-pil', 'python3-tqdm'}
# Used without an import: `ros2 launch`. RViz is for who has a screen, not a dependency.
COMMANDS = {'ros2launch'}


@pytest.fixture(scope='module')
def manifest():
    return ElementTree.parse(ROOT / 'package.xml').getroot()


def declared(manifest, *tags):
    return {element.text for tag in tags for element in manifest.findall(tag)}


def imported(*folders):
    """Return the keys of all packages that code in these folders imports and Python does not bring."""
    paths = [path for folder in folders for path in (ROOT / folder).rglob('*.py')]
    assert paths
    names = set()
    for path in paths:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                names |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and not node.level:
                names.add(node.module)
    tops = {name.partition('.')[0] for name in names} - {path.stem for path in paths} - {PACKAGE}
    return {KEYS.get(top, top) for top in tops - sys.stdlib_module_names}


def test_it_is_a_manifest_of_format_3_for_ament_python(manifest):
    assert manifest.get('format') == '3'
    assert manifest.findtext('name') == PACKAGE
    assert manifest.findtext('export/build_type') == 'ament_python'
    assert '@' in manifest.find('maintainer').get('email')


def test_authors_and_addresses_are_those_of_setup_py(manifest):
    setup = (ROOT / 'setup.py').read_text()
    addresses = {element.get('type'): element.text for element in manifest.findall('url')}
    assert addresses == {
        'website': re.search(r"\burl='(.+)'", setup)[1],
        'repository': re.search(r"'Source': '(.+)'", setup)[1],
        'bugtracker': re.search(r"'Bug Tracker': '(.+)'", setup)[1],
    }
    author = manifest.find('author')
    assert author.text == re.search(r"\bauthor='(.+)'", setup)[1]
    assert author.get('email') == re.search(r"author_email='(.+)'", setup)[1]


def test_the_licence_is_in_the_file_that_it_names(manifest):
    licence = manifest.find('license')
    assert licence.text == 'Apache-2.0'
    assert 'Apache License' in (ROOT / licence.get('file')).read_text()


def test_the_package_declares_what_it_imports_and_nothing_else(manifest):
    assert declared(manifest, 'depend') == imported('circle_bounce_ros') - OPTIONAL - FOR_COMMANDS


def test_the_launch_files_import_only_what_is_declared(manifest):
    assert declared(manifest, 'exec_depend') - COMMANDS == imported('launch') | FOR_COMMANDS


def test_examples_import_only_what_is_declared(manifest):
    assert imported('examples') <= declared(manifest, 'depend')


def test_the_tests_import_only_what_is_declared(manifest):
    assert imported('test') - OPTIONAL <= declared(
        manifest, 'depend', 'exec_depend', 'test_depend'
    )


def test_pip_installs_the_python_packages_that_rosdep_does(manifest):
    required = re.search(r'install_requires=\[(.*?)\]', (ROOT / 'setup.py').read_text(), re.DOTALL)
    viewer = re.search(r"'viewer': \[(.*?)\]", (ROOT / 'setup.py').read_text())
    names = re.findall(r"'([A-Za-z]+)", required[1] + viewer[1])
    keys = {KEYS[DISTRIBUTIONS.get(name, name)] for name in names}
    assert keys == {key for key in declared(manifest, 'depend') if key.startswith('python3-')}


def test_the_version_is_the_same_everywhere(manifest):
    setup = re.search(r"version='(.+)'", (ROOT / 'setup.py').read_text())
    newest = re.search(
        r'^(\d+\.\d+\.\d+) \(\d{4}-\d{2}-\d{2}\)\n-+$',
        (ROOT / 'CHANGELOG.rst').read_text(),
        re.MULTILINE,
    )
    assert manifest.findtext('version') == setup[1] == newest[1]
