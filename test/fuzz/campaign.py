"""Odd input with new seeds for some minutes: `make fuzz`. Inputs that fail are left in out/fuzz."""

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import time
import traceback
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / 'ros'))
sys.path.insert(0, str(Path(__file__).parents[1] / 'viewer'))

import live
from observing import NodeProcess, Observer
from targets import TARGETS
from viewing import VIEWER, address_of, end_all

HERE = Path(__file__).parent
OUT = HERE.parents[1] / 'out' / 'fuzz'
PATIENCE = 120  # s; a case takes milliseconds, of the live ones seconds


def node(rng, folder):
    """Start a node and give it odd requests."""
    play(
        folder,
        [],
        {},
        lambda observer, process: (
            observer.wait_for_node(),
            live.node(rng, folder, observer, process, 300),
        ),
    )


def viewer(rng, folder):
    """Start a viewer and give it odd messages."""
    play(
        folder,
        ['-p', 'port:=0'],
        {'program': VIEWER},
        lambda observer, process: live.viewer(
            rng, folder, observer, address_of(process), process, 20
        ),
    )


def play(folder, arguments, options, work):
    """Do something with a process of its own and an observer."""
    observer = Observer(int(os.environ.setdefault('ROS_DOMAIN_ID', '99')))
    process = NodeProcess(folder / 'log', *arguments, **options)
    try:
        work(observer, process)
    finally:
        end_all([process])
        observer.close()


ALL = TARGETS | {'node': node, 'viewer': viewer}


def ends_well(name, seed):
    """Run one case; what fails is kept, with its traceback."""
    folder = OUT / f'{name}-{seed}'
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    signal.alarm(PATIENCE)
    try:
        ALL[name](random.Random(f'{name} {seed}'), folder)
    except Exception:  # whatever it is, it is what is looked for
        fault = traceback.format_exc()
    else:
        shutil.rmtree(folder)
        return True
    finally:
        signal.alarm(0)
    (folder / 'traceback').write_text(fault)
    again = f'make fuzz ARGS="--target {name} --seed {seed}"'
    print(f'{name}: FAILED, input in {folder}, again with: {again}\n{fault}', flush=True)
    return False


def too_long(*_):
    raise TimeoutError(f'not within {PATIENCE} s')


def start_engine(seconds, seed):
    """Compare plain and compiled engine in another process, in which every index is checked."""
    environment = os.environ | {
        'NUMBA_BOUNDSCHECK': '1',
        'XDG_CACHE_HOME': str(OUT / 'cache'),
    }
    command = [sys.executable, HERE / 'engine.py', '--seconds', str(seconds), '--seed', str(seed)]
    return subprocess.Popen(command, env=environment)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--minutes', type=float, default=5.0)
    parser.add_argument('--target', choices=[*ALL, 'engine'], help='this one only')
    parser.add_argument('--seed', type=int, help='one case only, with this seed')
    chosen = parser.parse_args()
    signal.signal(signal.SIGALRM, too_long)
    one = chosen.seed is not None and chosen.target is not None
    seed = random.SystemRandom().randrange(10**9) if chosen.seed is None else chosen.seed
    seconds = 0.0 if one else 60.0 * chosen.minutes
    print(f'first seed {seed}', flush=True)
    OUT.mkdir(parents=True, exist_ok=True)
    names = [chosen.target] if chosen.target else list(ALL)
    engine = start_engine(seconds, seed) if chosen.target in (None, 'engine') else None
    counts = dict.fromkeys(names, 0)
    failed = 0
    if chosen.target != 'engine':
        failed = campaign(names, seed, seconds, counts)
    if engine is not None:
        try:
            failed += engine.wait(PATIENCE) != 0
        except subprocess.TimeoutExpired:
            engine.kill()
            print('engine: FAILED, does not end')
            failed += 1
    print('cases:', ', '.join(f'{name} {count}' for name, count in counts.items() if count))
    print(f'{failed} failed' if failed else 'none failed')
    return int(failed > 0)


def campaign(names, seed, seconds, counts):
    """Run cases until time is up, each target for as long as the others; return how many failed."""
    failed, spent = 0, dict.fromkeys(names, 0.0)
    began = time.monotonic()
    while True:
        name = min(names, key=spent.__getitem__)
        start = time.monotonic()
        failed += not ends_well(name, seed + counts[name])
        counts[name] += 1
        spent[name] += time.monotonic() - start
        if time.monotonic() - began >= seconds:
            return failed


if __name__ == '__main__':
    sys.exit(main())
