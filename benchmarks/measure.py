"""CPU time of several at the same work, in turn, so that whatever else the machine does meets all of them."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from typing import Any

from benchmarks.contestants import Contestant

# Does some work and says how much: frames, contacts, whatever is counted.
Work = Callable[[], float]


class Pace:
    """
    How thorough to be.

    Parameters
    ----------
    rounds : int
        How often everybody gets a turn.
    block : float, s
        How long a turn takes.
    largest : int
        Circles in the largest scenes.

    """

    def __init__(self, rounds: int, block: float, largest: int) -> None:
        self.rounds = rounds
        self.block = block
        self.largest = largest


LONG = Pace(rounds=9, block=0.25, largest=100_000)
SHORT = Pace(rounds=2, block=0.005, largest=300)


def in_turn(works: Sequence[Work], pace: Pace) -> list[list[float]]:
    """
    Return the CPU time of each per unit of its work, one number a round, s.

    Each repeats its work until a block is full; a first round, which nobody counts, warms up.
    """
    costs: list[list[float]] = [[] for _ in works]
    for number in range(pace.rounds + 1):
        for work, found in zip(works, costs, strict=True):
            cost = one_turn(work, pace.block)
            if number > 0:
                found.append(cost)
    return costs


def one_turn(work: Work, block: float) -> float:
    """
    Return the CPU time per unit of work, s, of as many repetitions as fill a block.

    The clock is read after ever more of them: to ask for the time costs as much as a third of a frame of one ball.
    """
    amount = 0.0
    done, repetitions = 0, 1
    began = time.process_time()
    while True:
        for _ in range(repetitions):
            amount += work()
        done += repetitions
        passed = time.process_time() - began
        if passed >= block and amount > 0.0:
            return passed / amount
        left = (block - passed) / passed * done if passed > 0.0 else done
        repetitions = max(1, min(done, int(left)))


def frames_of(one: Contestant) -> Work:
    """Return the work of one frame."""

    def work() -> float:
        one.show_frame()
        return 1.0

    return work


def ratios(theirs: Sequence[float], ours: Sequence[float]) -> list[float]:
    """Return their cost by ours, round by round."""
    return [a / b for a, b in zip(theirs, ours, strict=True)]


def summary(values: Sequence[float]) -> dict[str, Any]:
    """Return median, quartiles and how many."""
    low, middle, high = (
        statistics.quantiles(values, n=4, method='inclusive') if len(values) > 1 else values * 3
    )
    return {'median': middle, 'low': low, 'high': high, 'rounds': len(values)}
