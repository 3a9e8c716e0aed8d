"""The commands that README and docs show work as they are written, and give the pictures that are shown."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from conftest import ROOT
from PIL import Image

from circle_bounce_ros.offline import plot, record, sweep

RECORDING = ROOT / 'docs/recording.md'
README = ROOT / 'README.md'
SHOWN = ROOT / 'docs/recording'
BIN = Path(sys.prefix) / 'bin'

# Smaller where a command is written for minutes or gigabytes.
SHORTER = {'600': '6', '100000': '6'}


def commands_in(document):
    """Return all commands that a document shows, as lists of words."""
    lines = re.findall(
        r'^    (?:time )?(bounce_(?:record|plot|sweep) .+)$', document.read_text(), re.M
    )
    return [shlex.split(line, comments=True) for line in lines]


def in_order(commands):
    """Return commands so that what another one reads is made first, and each only once."""
    unique = [list(words) for words in dict.fromkeys(map(tuple, commands))]
    return sorted(unique, key=lambda words: words[0] == 'bounce_plot')


def small_sweep(folder):
    """Put the example of a sweep where the commands look for it, with fewer runs of fewer disks."""
    examples = folder / 'examples/sweeps'
    examples.mkdir(parents=True)
    given = yaml.safe_load((ROOT / 'examples/sweeps/pressure.yaml').read_text())
    given['parameters']['groups[0].packing']['steps'] = 2
    given |= {'seeds': {'first': 1, 'count': 2}, 'duration': 2.0, 'warm_up': 1.0}
    (examples / 'pressure.yaml').write_text(yaml.safe_dump(given))
    scene = (ROOT / 'examples/sweeps/hard_disks.yaml').read_text()
    (examples / 'hard_disks.yaml').write_text(scene.replace('count: 4000', 'count: 400'))


def test_the_commands_of_the_documents_work_as_written(tmp_path):
    if not (BIN / 'bounce_record').exists():
        pytest.skip(f'{BIN}/bounce_record is not there: install the package')
    small_sweep(tmp_path)
    # What both show is one command.
    found = [commands_in(document) for document in (RECORDING, README)]
    assert min(map(len, found)) >= 4
    for words in in_order([words for commands in found for words in commands]):
        if 'tcp://HOST:8786' in words:
            continue
        if '--repair' in words:
            # A recording that was cut short: its metadata is what is written last.
            (tmp_path / words[-1] / 'metadata.yaml').unlink()
        done = subprocess.run(
            [str(BIN / words[0]), *(SHORTER.get(word, word) for word in words[1:])],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert done.returncode == 0, f'{words}: {done.stderr}'
        assert not done.stderr, words


PICTURES = ['trajectories', 'animation', 'speeds', 'free_path', 'energy']


@pytest.mark.parametrize('name', PICTURES)
def test_a_picture_of_the_document_is_what_its_command_draws(tmp_path, monkeypatch, name):
    """If this fails for good reason: draw them anew into docs/recording, look at them, commit them."""
    (words,) = [
        words for words in commands_in(RECORDING) if words[1] == name and 'out/gas' not in words
    ]
    monkeypatch.chdir(tmp_path)
    assert plot.main(words[1:]) == 0
    with Image.open(words[-1]) as drawn, Image.open(SHOWN / Path(words[-1]).name) as shown:
        assert drawn.size == shown.size
        assert drawn.info.get('Numbers') == shown.info.get('Numbers')
        assert getattr(drawn, 'n_frames', 1) == getattr(shown, 'n_frames', 1)


def test_every_picture_has_a_command_and_is_shown():
    drawn = {words[1] for words in commands_in(RECORDING) if words[0] == 'bounce_plot'}
    assert drawn == {*PICTURES, 'pressure'}
    text = RECORDING.read_text()
    files = {path.name for path in SHOWN.iterdir()}
    assert {path.rpartition('.')[0] for path in files} == drawn
    assert all(f'recording/{name}' in text for name in files)


@pytest.mark.parametrize(
    ('module', 'section'), [(record, 'Record'), (plot, 'Plot'), (sweep, 'Sweep')]
)
def test_every_option_is_in_the_document(capsys, module, section):
    with pytest.raises(SystemExit):
        module.main(['--help'])
    options = set(re.findall(r'--[a-z-]+', capsys.readouterr().out)) - {'--help', '--output'}
    (part,) = re.findall(rf'^## {section}\n(.*?)(?=^## |\Z)', RECORDING.read_text(), re.M | re.S)
    assert options
    assert sorted(option for option in options if option not in part) == []


def test_the_sweep_of_the_document_is_the_example():
    (shown,) = re.findall(r'^```yaml\n(.*?)^```$', RECORDING.read_text(), re.M | re.S)
    example = yaml.safe_load((ROOT / 'examples/sweeps/pressure.yaml').read_text())
    assert yaml.safe_load(shown) == {'record': 'none'} | example
