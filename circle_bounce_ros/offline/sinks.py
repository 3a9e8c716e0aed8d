"""Where a recording may go: which formats there are, and what each of them can hold."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path

from circle_bounce_ros.kernel import Scene
from circle_bounce_ros.offline.bag import Bag, topics_of
from circle_bounce_ros.offline.parquet import TABLES, ParquetFolder
from circle_bounce_ros.offline.recording import Sink
from circle_bounce_ros.scene_file.wording import named, shortened

BAG, PARQUET = 'bag', 'parquet'


class TopicsError(ValueError):
    """Why topics cannot be recorded; `problem` is the rule and the value."""

    def __init__(self, problem: str) -> None:
        super().__init__(f'topics: {problem}')
        self.problem = problem


def topics_to_record(names: Sequence[str], scene: Scene, form: str) -> tuple[str, ...]:
    """
    Return topics, or tables, as they are called; a leading slash is left out or put in.

    Raises
    ------
    TopicsError
        For names of nothing, a name given twice, or none at all.

    """
    topics = list(TABLES) if form == PARQUET else [topic.name for topic in topics_of(scene)]
    known = {name.lstrip('/'): name for name in topics}
    found = [name if name in topics else known.get(name.removeprefix('/')) for name in names]
    unknown = [name for name, topic in zip(names, found, strict=True) if topic is None]
    if unknown or not names:
        got = shortened(', '.join(map(named, unknown))) or 'none'
        raise TopicsError(f'must be from {_some(topics)}, got {got}')
    chosen = tuple(topic for topic in found if topic is not None)
    for place, topic in enumerate(chosen):
        if topic in chosen[:place]:
            raise TopicsError(f'must be given once, got {named(topic)} twice')
    return chosen


def _some(names: list[str], most: int = 20) -> str:
    left = len(names) - most
    return ', '.join(map(named, names[:most])) + (f' and {left} more' if left > 0 else '')


def open_sink(
    folder: Path,
    scene: Scene,
    form: str,
    topics: Collection[str] | None,
    frame_id: str = 'world',
    compress: bool = False,
) -> Sink:
    """
    Begin a recording in a new folder.

    Parameters
    ----------
    folder : Path
        Must not exist.
    scene : Scene
    form : str
        `BAG` or `PARQUET`.
    topics : collection of str, optional
        As `topics_to_record` returns them; by default all.
    frame_id : str
        Of a bag.
    compress : bool
        A bag.

    Raises
    ------
    OSError
        When the folder cannot be made.

    """
    if form == PARQUET:
        return ParquetFolder(folder, scene, topics)
    return Bag(folder, scene, frame_id, topics, compress)
