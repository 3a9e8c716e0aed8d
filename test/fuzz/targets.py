"""
What may get odd input, in this process: each target raises for what must not happen.

A target takes a `random.Random` and an empty folder, in which it leaves its input before it uses it. It may return
whether the input was good.
"""

import io
import shutil
from contextlib import redirect_stderr, redirect_stdout
from functools import lru_cache
from pathlib import Path
from tempfile import mkdtemp

import yaml
from inputs import GOOD_SCENE, GOOD_SWEEP, damage, socket_message, yaml_file

from circle_bounce_ros.kernel import Scene, SceneError
from circle_bounce_ros.scene_file import check_main, load_scene, reading


def is_one_line_about(path, text):
    """Is this a sentence about a file, with no more than a place, a rule and a value?"""
    return text.startswith(f'{path}: ') and text.isprintable() and len(text) < len(str(path)) + 600


def outcome(path, loader):
    """Return the scene that a file gives with a parser, or the sentence that refuses it."""
    fast, reading.FastLoader = reading.FastLoader, loader
    try:
        return load_scene(path)
    except SceneError as error:
        return str(error)
    finally:
        reading.FastLoader = fast


def scene(rng, folder):
    """Check that a scene file gives a scene or a sentence with both parsers, as bounce_check says."""
    path = folder / 'scene.yaml'
    path.write_bytes(yaml_file(GOOD_SCENE, rng))
    result = outcome(path, reading.FastLoader)
    assert isinstance(result, Scene) or is_one_line_about(path, result), result
    again = outcome(path, yaml.SafeLoader)
    # They differ in what is an error at all, a tab for instance; what both read is the same.
    assert isinstance(again, Scene) or is_one_line_about(path, again), again
    assert result == again or isinstance(result, str) or isinstance(again, str)
    with redirect_stdout(io.StringIO()) as out:
        status = check_main([str(path)])
    assert status == (0 if isinstance(result, Scene) else 1)
    assert is_one_line_about(path, out.getvalue().rstrip('\n')), out.getvalue()
    return status == 0


def sweep(rng, folder):
    """Check that a sweep file gives a plan or a sentence."""
    from circle_bounce_ros.offline.sweep import PlanError, load_plan

    path = folder / 'sweep.yaml'
    path.write_bytes(yaml_file(GOOD_SWEEP, rng))
    try:
        load_plan(path)
        return True
    except PlanError as error:
        text = str(error)
    assert is_one_line_about(path, text), text
    return False


class Log:
    """Stands for the viewer's ROS side."""

    def log(self, text):
        assert text.isprintable(), text

    def publishers(self):
        return []


@lru_cache(maxsize=1)
def good_messages():
    """Return a serialized message of each kind that the viewer reads, by its channel."""
    from circle_bounce_ros.encoding.topics import (
        Moment,
        State,
        feeds_of_a_scene,
        feeds_of_each_tick,
    )
    from circle_bounce_ros.kernel import Simulation

    shown = load_scene('pegboard')
    simulation = Simulation(shown, record_contacts=True)
    simulation.advance_to(2.0)
    moment = Moment(2 * 10**9, 2 * 10**9, State(simulation))
    feeds = dict(feeds_of_each_tick(shown, 'world', False)) | dict(
        feeds_of_a_scene(shown, 'world')
    )
    by_name = {topic.name: bytes(encode(moment)) for topic, encode in feeds.items()}
    names = {
        'bodies': 'bodies',
        'contacts': 'contacts',
        'time': 'time',
        'static': 'markers/static',
    }
    return {channel: by_name[name] for channel, name in names.items()}


def topic(rng, folder):
    """Check that the viewer takes any bytes on its topics, and says in a sentence what it cannot read."""
    from circle_bounce_ros.viewer.clients import Client
    from circle_bounce_ros.viewer.server import Server

    server = Server()
    server._link = Log()
    server._log = server._link.log
    client = Client(None, server._frames)
    client.circle = 0
    server._clients.add(client)
    for channel, message in good_messages().items():
        odd = damage(message, rng)
        (folder / channel).write_bytes(odd)
        server.hear(channel, odd)
    if server._frames.bodies is not None:
        server._frames.bodies_frame()


def socket(rng, folder):
    """Check that what a page says is a message or is refused."""
    from circle_bounce_ros.viewer.messages import MessageError, read

    text = socket_message(rng)
    (folder / 'message').write_bytes(text if isinstance(text, bytes) else text.encode())
    try:
        read(text)
        return True
    except MessageError as error:
        reason = str(error)
    assert reason.isprintable(), reason
    return False


@lru_cache(maxsize=2)
def good_recording(form):
    """Return the folder of a short recording."""
    from circle_bounce_ros.offline.record import main

    folder = Path(mkdtemp(prefix='fuzz')) / form
    arguments = ['pegboard', '--duration', '0.5', '--rate', '20', '--format', form]
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
        assert main([*arguments, '-o', str(folder)]) == 0
    return folder


def damaged_recording(rng, folder, form):
    """Return a copy of a recording in which one file is damaged."""
    copied = folder / form
    shutil.copytree(good_recording(form), copied)
    files = sorted(path for path in copied.rglob('*') if path.is_file())
    path = rng.choice(files)
    if rng.random() < 0.05:
        path.unlink()
    else:
        path.write_bytes(damage(path.read_bytes(), rng))
    return copied


def ends_in_words(main, arguments):
    """Run a command in this process: it must end with 0 or, having said why, with 1."""
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()) as error:
        status = main(arguments)
    assert status in (0, 1), (status, error.getvalue())
    assert status == 0 or error.getvalue(), 'failed without a word'
    assert 'Traceback' not in error.getvalue(), error.getvalue()


def bag(rng, folder):
    """Check that a damaged bag is drawn or refused in words, and repaired or not."""
    from circle_bounce_ros.offline import plot, record

    damaged = damaged_recording(rng, folder, 'bag')
    if rng.random() < 0.5:
        (damaged / 'metadata.yaml').unlink(missing_ok=True)
        ends_in_words(record.main, ['--repair', str(damaged)])
    ends_in_words(plot.main, ['speeds', str(damaged), '-o', str(folder / 'speeds.svg')])


def table(rng, folder):
    """Check that a damaged table is repaired, or that is refused in words."""
    from circle_bounce_ros.offline import plot, record

    damaged = damaged_recording(rng, folder, 'parquet')
    ends_in_words(record.main, ['--repair', str(damaged)])
    ends_in_words(plot.main, ['speeds', str(damaged), '-o', str(folder / 'speeds.svg')])


TARGETS = {f.__name__: f for f in (scene, sweep, topic, socket, bag, table)}
