"""What `colcon build` installs is complete, and it runs."""

import signal
import subprocess
import sys

import pytest
from installs import PACKAGE, PATIENCE, ROOT, first_message, run

from circle_bounce_ros.installation import child_environment

WHERE = """
import circle_bounce_ros
from circle_bounce_ros.installation import share_directory
print(circle_bounce_ros.__file__, share_directory(), sep='\\n')
"""


@pytest.fixture
def prefix(colcon_install):
    return colcon_install / PACKAGE


def sourced(colcon_install, *command):
    """Return a command line that runs a command as in a terminal that has sourced the workspace."""
    line = f'. {colcon_install}/setup.sh && exec "$@"'
    return ['sh', '-c', line, 'sh', *(str(word) for word in command)]


@pytest.mark.parametrize('name', ['bounce_node', 'bounce_viewer', 'bounce_check'])
def test_ros2_run_finds_the_executables(prefix, name):
    executable = prefix / 'lib' / PACKAGE / name
    assert executable.is_file()
    assert executable.stat().st_mode & 0o111 == 0o111


def test_ament_finds_the_package(prefix):
    assert (prefix / 'share/ament_index/resource_index/packages' / PACKAGE).is_file()


@pytest.mark.parametrize('folder', ['config', 'launch'])
def test_every_file_for_users_is_installed_unchanged(prefix, folder):
    files = [path for path in (ROOT / folder).rglob('*') if path.is_file()]
    assert files
    for path in files:
        if '__pycache__' not in path.parts:
            installed = prefix / 'share' / PACKAGE / path.relative_to(ROOT)
            assert installed.read_bytes() == path.read_bytes()


@pytest.mark.parametrize('name', ['package.xml', 'LICENSE'])
def test_the_manifest_and_its_licence_are_installed(prefix, name):
    assert (prefix / 'share' / PACKAGE / name).read_bytes() == (ROOT / name).read_bytes()


def test_the_installed_package_finds_its_own_files(colcon_install, source_tree, tmp_path):
    said = run(*sourced(colcon_install, sys.executable, '-c', WHERE), cwd=tmp_path)
    module, share = said.split()
    workspace = colcon_install.parent
    # --symlink-install leads back to the sources that it was built from, and so must their files.
    homes = (str(workspace), str(source_tree))
    assert module.startswith(homes)
    assert share.startswith(homes)


def test_the_installed_check_accepts_a_packaged_scene(colcon_install, prefix, tmp_path):
    program = prefix / 'lib' / PACKAGE / 'bounce_check'
    scene = prefix / 'share' / PACKAGE / 'config/scenes/lesson.yaml'
    run(*sourced(colcon_install, sys.executable, program, scene), cwd=tmp_path)


def test_the_installed_node_publishes_and_ends_with_status_0(
    colcon_install, prefix, listener, tmp_path
):
    heard = listener('pose', '/green/pose')
    program = prefix / 'lib' / PACKAGE / 'bounce_node'
    log = tmp_path / 'log'
    with log.open('w') as output:
        node = subprocess.Popen(
            sourced(colcon_install, sys.executable, program),
            cwd=tmp_path,
            env=child_environment(),
            stdout=output,
            stderr=subprocess.STDOUT,
        )
    try:
        assert len(first_message(heard)) == 2
        node.send_signal(signal.SIGINT)
        assert node.wait(PATIENCE) == 0, log.read_text()
        assert 'Traceback' not in log.read_text()
    finally:
        node.kill()
        node.wait()
