"""bounce_record: a scene into a rosbag2 or Parquet tables, as fast as it goes."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from tqdm import tqdm

from circle_bounce_ros.encoding.topics import Moment
from circle_bounce_ros.kernel import EndlessContactsError, SceneError, Simulation
from circle_bounce_ros.offline.files import is_utf8
from circle_bounce_ros.offline.recording import moments
from circle_bounce_ros.offline.repair import RepairError, clean, is_of_tables, repair
from circle_bounce_ros.offline.sinks import (
    BAG,
    PARQUET,
    TopicsError,
    open_sink,
    topics_to_record,
)
from circle_bounce_ros.offline.stopping import INTERRUPTED, Stopping
from circle_bounce_ros.scene_file import load_scene
from circle_bounce_ros.scene_file.wording import shown
from circle_bounce_ros.schedule.recording import RecordingTicks
from circle_bounce_ros.schedule.times import SECOND

COMMAND = 'bounce_record'

# A bar that is drawn at each tick costs more than the tick.
BAR_PERIOD = 0.2  # s


class RecordError(ValueError):
    """Why there is no recording, or only a part of it, in one sentence."""


def arguments_of(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Return the parsed command line."""
    parser = argparse.ArgumentParser(
        prog=COMMAND,
        description='Record a scene as fast as it goes, with the topics and bytes of the node in clock mode.',
    )
    parser.add_argument('scene', nargs='?', help='name of a packaged scene, or path of a file')
    parser.add_argument('-o', '--output', type=Path, metavar='FOLDER', help='must not exist')
    parser.add_argument('--duration', type=float, default=60.0, help='s of scene time; default 60')
    parser.add_argument('--rate', type=float, default=60.0, help='ticks a second, Hz; default 60')
    parser.add_argument('--seed', type=int, help="in place of the scene file's own")
    parser.add_argument(
        '--topics', nargs='+', metavar='TOPIC', help='only these, for instance: poses bodies'
    )
    parser.add_argument('--format', choices=[BAG, PARQUET], default=BAG)
    parser.add_argument(
        '--frame-id', default='world', help='frame of all positions; default world'
    )
    parser.add_argument('--compress', action='store_true', help='a smaller bag, more slowly')
    parser.add_argument(
        '--repair', type=Path, metavar='FOLDER', help='make a recording whole that was cut short'
    )
    chosen = parser.parse_args(arguments)
    if chosen.repair is None and (chosen.scene is None or chosen.output is None):
        parser.error('SCENE and --output are needed (or --repair FOLDER)')
    others = [name for name in vars(chosen) if name != 'repair']
    if chosen.repair and any(getattr(chosen, n) != parser.get_default(n) for n in others):
        parser.error('--repair goes with nothing else')
    return chosen


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Record.

    Returns
    -------
    int
        0; 1 when something is wrong; 130 after Ctrl-C, with what was recorded until then.

    """
    chosen = arguments_of(arguments)
    try:
        if chosen.repair is not None:
            return repair_bag(chosen.repair)
        return record(chosen)
    except (RecordError, RepairError, SceneError, TopicsError) as error:
        print(f'{COMMAND}: {error}', file=sys.stderr)
        return 1
    except OSError as error:
        print(f'{COMMAND}: {error.filename or ""}: {error.strerror}', file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        # In a repair, which leaves everything as it was, or the second one in a recording, which has said so.
        return INTERRUPTED


def record(chosen: argparse.Namespace) -> int:
    """Record what the command line says and return the exit status."""
    scene = load_scene(chosen.scene, chosen.seed)
    topics = chosen.topics and topics_to_record(chosen.topics, scene, chosen.format)
    if not chosen.frame_id:
        raise RecordError("frame-id: must not be empty, got ''")
    if not is_utf8(chosen.frame_id):
        raise RecordError(f'frame-id: must be UTF-8 text, got {shown(chosen.frame_id)}')
    if chosen.format == PARQUET and not is_utf8(chosen.output):
        raise RecordError(f'output: must be UTF-8 for tables, got {shown(str(chosen.output))}')
    try:
        ticks = RecordingTicks(chosen.rate, chosen.duration, scene.restart_after)
    except ValueError as error:
        raise RecordError(str(error)) from None
    folder: Path = chosen.output
    if folder.exists() or folder.is_symlink():
        raise RecordError(f'{folder}: exists already, nothing was touched')
    began = time.monotonic()
    last: Moment | None = None
    with Stopping() as stop, ProgressBar(ticks, len(scene.circles)) as bar:
        sink = open_sink(folder, scene, chosen.format, topics, chosen.frame_id, chosen.compress)
        try:
            simulation = Simulation(scene, record_contacts=sink.wants_contacts)
            for last in moments(simulation, ticks, stop):
                sink.write(last)
                bar.show(last.stamp_ns)
            sink.close()
        except (OSError, EndlessContactsError) as error:
            sink.abort()
            raise RecordError(broken(folder, error, last, chosen.format)) from error
        except KeyboardInterrupt as error:
            sink.abort()
            print(f'{COMMAND}: {broken(folder, error, last, chosen.format)}', file=sys.stderr)
            raise
        except BaseException:
            sink.abort()
            raise
    end = last.stamp_ns / SECOND if last else 0.0
    took = time.monotonic() - began
    stopped = 'stopped after ' if stop() else ''
    print(
        f'{folder}: {stopped}{end:.9g} s of {scene.name}, {size(folder) / 1e6:.1f} MB, '
        f'in {took:.1f} s ({end / took:.0f} times real time)'
    )
    return stop.exit_status


def broken(folder: Path, error: BaseException, last: Moment | None, form: str) -> str:
    """Return what went wrong in the middle, and what is left."""
    reason = error.strerror if isinstance(error, OSError) else str(error) or 'interrupted'
    at = f'{last.stamp_ns / SECOND:.9g} s' if last else 'the beginning'
    left = (
        'the parts that were written are whole'
        if form == PARQUET
        else f'what was written becomes readable by: {COMMAND} --repair {folder}'
    )
    return f'{folder}: {reason}, at {at}; {left}'


def size(folder: Path) -> int:
    """Return the size of all files, bytes."""
    return sum(path.stat().st_size for path in folder.rglob('*') if path.is_file())


class ProgressBar:
    """A bar with the time left, on a terminal; none elsewhere."""

    def __init__(self, ticks: RecordingTicks, circles: int) -> None:
        self._shown = 0.0
        self._bar = tqdm(
            total=ticks.duration,
            unit='s',
            desc=f'{circles} circles',
            disable=None,
            file=sys.stderr,
            mininterval=BAR_PERIOD,
            bar_format='{desc} {percentage:3.0f}% |{bar}| {n:.0f}/{total:.0f} s, {remaining} left{postfix}',
        )

    def __enter__(self) -> ProgressBar:
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.close()

    def show(self, stamp_ns: int) -> None:
        """Show how far the recording is."""
        now = stamp_ns / SECOND
        self._bar.update(now - self._shown)
        self._shown = now


def repair_bag(folder: Path) -> int:
    """Repair a recording, say what was saved, and return the exit status."""
    if is_of_tables(folder):
        clean(folder)
        print(f'{folder}: its tables are whole')
        return 0
    with tqdm(unit='B', unit_scale=True, disable=None, file=sys.stderr, desc='read') as bar:
        repaired = repair(folder, lambda place: bar.update(place - bar.n))
    print(f'{folder}: repaired, {repaired.messages} messages up to {repaired.end:.9g} s')
    return 0


if __name__ == '__main__':
    sys.exit(main())
