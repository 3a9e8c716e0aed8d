"""
How the programs that need ROS begin: help, signals, and a sentence where something is missing.

Standard library only, so that all of this is in place before the slow imports of ROS begin.
"""

from __future__ import annotations

import argparse
import signal
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any, NamedTuple

from circle_bounce_ros.installation import missing_package

ROS_ARGS, ROS_ARGS_END = '--ros-args', '--'
ENDING_SIGNALS = (signal.SIGINT, signal.SIGTERM)
WRONG_ARGUMENTS = 2  # the exit status, as argparse has it


class ParameterRow(NamedTuple):
    """
    A parameter as it is declared, described and listed by --help.

    Attributes
    ----------
    name : str
    default : bool, int, float or str
    description : str
        With the unit.
    limits : (number, number) or None
        The smallest and the largest value.
    read_only : bool
        Given at the start only.

    """

    name: str
    default: Any
    description: str
    limits: tuple[Any, Any] | None = None
    read_only: bool = False


class Program(NamedTuple):
    """
    A program that needs ROS.

    Attributes
    ----------
    name : str
    description : str
    parameters : list of ParameterRow
    module : str
        Has the function `run` of type `Run`. Imported when it is needed.

    """

    name: str
    description: str
    parameters: list[ParameterRow]
    module: str


class Ending:
    """
    Whether somebody has asked the program to end.

    A KeyboardInterrupt can get lost, in a destructor or a callback from C; this remembers it.
    """

    def __init__(self) -> None:
        self.is_asked = False

    def ask(self, *_: object) -> None:
        """Remember; a signal handler."""
        self.is_asked = True

    def interrupt(self, *_: object) -> None:
        """Remember, and end what is being done."""
        self.ask()
        raise KeyboardInterrupt


# What is started: with the command line and whether it is to end already; returns the exit status.
Run = Callable[[Sequence[str], Ending], int]


def start(program: Program, args: Sequence[str] | None) -> int:
    """
    Run a program; Ctrl-C and SIGTERM end it with status 0, at any time.

    Parameters
    ----------
    program : Program
    args : sequence of str, optional
        The command line without the name of the program.

    Returns
    -------
    int
        The exit status: 2 for arguments that ROS would pass over in silence.

    """
    ending = Ending()
    # An exception in the middle of an import leaves half a module behind, and a traceback.
    on_signals(ending.ask)
    arguments = list(sys.argv[1:] if args is None else args)
    parser(program).parse_args(without_ros_arguments(arguments))
    try:
        run: Run = import_module(program.module).run
    except ModuleNotFoundError as error:
        print(f'{program.name}: {missing_package(error, "ros")}', file=sys.stderr)
        return 1
    try:
        on_signals(ending.interrupt)
        return 0 if ending.is_asked else run(arguments, ending)
    except KeyboardInterrupt:
        return 0
    finally:
        # Python itself would give SIGTERM its deadly meaning back while it ends.
        on_signals(signal.SIG_IGN)


def on_signals(handler: Any) -> None:
    """Treat Ctrl-C and SIGTERM alike, from now on even if whoever started us had blocked them."""
    for number in ENDING_SIGNALS:
        signal.signal(number, handler)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING_SIGNALS)


def without_ros_arguments(arguments: list[str]) -> list[str]:
    """Return the arguments that are not between --ros-args and -- or the end."""
    left = []
    for_ros = False
    for argument in arguments:
        if argument == ROS_ARGS:
            for_ros = True
        elif for_ros and argument == ROS_ARGS_END:
            for_ros = False
        elif not for_ros:
            left.append(argument)
    return left


def parser(program: Program) -> argparse.ArgumentParser:
    """Return a parser that knows --help only: everything else is for ROS, behind --ros-args."""
    names = [f'{row.name} (default {_written(row.default)})' for row in program.parameters]
    width = max(map(len, names))
    rows = []
    for name, row in zip(names, program.parameters, strict=True):
        limits = ' From {} to {}.'.format(*map(_written, row.limits)) if row.limits else ''
        rows.append(f'  {name:{width}}  {row.description}{limits}')
    return argparse.ArgumentParser(
        prog=program.name,
        description=program.description,
        usage=f'{program.name} [-h] [{ROS_ARGS} -p NAME:=VALUE ... -r FROM:=TO ...]',
        epilog='\n'.join(['parameters:', *rows]),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )


def _written(value: Any) -> str:
    """Return a value as YAML has it."""
    return str(value).lower() if isinstance(value, bool) else f'{value}'
