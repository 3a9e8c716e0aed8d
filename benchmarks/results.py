"""Where numbers are kept: one JSON file a part of the benchmark, beside the document that shows them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).resolve().parents[1] / 'docs' / 'benchmarks'


def save(part: str, found: dict[str, Any], folder: Path = FOLDER) -> Path:
    """Write what a part has found."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f'{part}.json'
    path.write_text(json.dumps(found, indent=1) + '\n')
    return path


def load(part: str, folder: Path = FOLDER) -> dict[str, Any] | None:
    """Return what a part found last, None if it never ran."""
    path = folder / f'{part}.json'
    return json.loads(path.read_text()) if path.exists() else None
