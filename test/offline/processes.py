"""Processes that the tests of sweeps start: on a terminal, and as a cluster."""

from __future__ import annotations

import fcntl
import json
import os
import pty
import signal
import struct
import subprocess
import sys
import termios
import threading
from contextlib import suppress
from pathlib import Path

from conftest import ROOT, wait_until


class Terminal:
    """A command on a terminal of its own."""

    def __init__(self, command, *arguments):
        self._ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack('HHHH', 30, 100, 0, 0))
        module = f'circle_bounce_ros.offline.{command.removeprefix("bounce_")}'
        self._process = subprocess.Popen(
            [sys.executable, '-m', module, *map(str, arguments)],
            cwd=ROOT,
            stdin=theirs,
            stdout=theirs,
            stderr=theirs,
            start_new_session=True,
            preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0),
        )
        os.close(theirs)
        self._shown = b''
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def _read(self):
        # Reading fails when the last process of the terminal has ended.
        with suppress(OSError):
            while more := os.read(self._ours, 1 << 16):
                self._shown += more

    def press_ctrl_c(self):
        os.write(self._ours, b'\x03')

    def wants_to_end(self):
        """Return whether a first signal has been noted, after which no handler waits for SIGTERM."""
        status = Path(f'/proc/{self._process.pid}/status').read_text()
        caught = int(status.partition('SigCgt:')[2].split()[0], 16)
        return not caught & 1 << signal.SIGTERM - 1

    def end(self):
        """Wait for the end and return the exit status and all that was shown."""
        status = self._process.wait(timeout=60)
        self._reader.join(timeout=60)
        return status, self._shown.decode()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.wait(timeout=60)
        self._reader.join(timeout=60)
        os.close(self._ours)


class Cluster:
    """A scheduler and workers, each in a process of its own."""

    def __init__(self, folder):
        self._folder = folder
        self._file = folder / 'scheduler.json'
        options = ['--port', '0', '--no-dashboard', '--scheduler-file', self._file]
        self.scheduler = self._start('scheduler', *options)
        self.processes = [self.scheduler]
        wait_until(self._file.exists, 'a scheduler')
        self.address = json.loads(self._file.read_text())['address']
        self.workers = []

    def _start(self, kind, *options):
        log = (self._folder / f'{kind}{len(getattr(self, "processes", []))}.log').open('w')
        with log:
            return subprocess.Popen(
                [sys.executable, '-m', f'distributed.cli.dask_{kind}', *map(str, options)],
                stdout=log,
                stderr=log,
                cwd=self._folder,
            )

    def add_worker(self):
        options = ['--nthreads', 1, '--no-nanny', '--no-dashboard', '--scheduler-file', self._file]
        self.workers.append(self._start('worker', *options))
        self.processes.append(self.workers[-1])

    def end(self):
        for process in reversed(self.processes):
            process.kill()
            process.wait(timeout=60)


def workers_of(process):
    """Return the process numbers of the workers that a sweep has started."""
    found = []
    for folder in Path('/proc').glob('[0-9]*'):
        # Processes end while one looks.
        with suppress(OSError):
            parent = int((folder / 'stat').read_text().rpartition(')')[2].split()[1])
            if parent == process.pid and b'spawn_main' in (folder / 'cmdline').read_bytes():
                found.append(int(folder.name))
    return found
