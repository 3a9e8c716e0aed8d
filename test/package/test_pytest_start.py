"""Pytest starts and collects as `colcon test` and people start it: with plugins of ROS, and with packages missing."""

import sys

from installs import ROOT, run

# As launch_testing has it: 3.4 does not start under pytest 9, and lets the first module that skips end the session.
PLUGIN = 'raise RuntimeError("the plugin of launch_testing was loaded")'
ENTRIES = '[pytest11]\nlaunch_testing = ros_plugin\nlaunch_ros = ros_plugin\nlaunch_pytest = ros_plugin\n'


def collect(folder, *arguments, **environment):
    """Return what pytest says in the source tree, with a folder before all others that Python looks in."""
    command = [sys.executable, '-m', 'pytest', '--collect-only', '-q', '-p', 'no:cacheprovider']
    return run(
        *[*command, *arguments],
        cwd=ROOT,
        **{'PYTHONPATH': str(folder), 'PYTEST_DISABLE_PLUGIN_AUTOLOAD': '', **environment},
    )


def test_the_plugins_of_a_sourced_ros_are_not_loaded(tmp_path):
    information = tmp_path / 'launch_testing-3.4.0.dist-info'
    information.mkdir()
    (information / 'METADATA').write_text('Name: launch-testing\nVersion: 3.4.0\n')
    (information / 'entry_points.txt').write_text(ENTRIES)
    (tmp_path / 'ros_plugin.py').write_text(PLUGIN)
    assert '/test_schedules.py::' in collect(tmp_path, 'test/schedule')


def test_a_folder_that_needs_what_is_missing_skips_in_words_and_alone(tmp_path):
    (tmp_path / 'nothing.py').write_text('import sys\nsys.modules["rosbags"] = None\n')
    said = collect(tmp_path, '-p', 'nothing', 'test/offline', 'test/schedule')
    assert 'needs rosbags, which is not installed' in said
    assert '/test_schedules.py::' in said
    assert 'test/offline/test_bag.py::' not in said
