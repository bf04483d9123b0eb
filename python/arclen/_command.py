"""The program ``arclen``, within this process."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Sequence
from typing import Any

from . import _arclen


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the program ``arclen`` within this process.

    It writes to the standard output and error of the process, without the interpreter's lock. Ctrl-C asks a
    computation to stop: it keeps what it has and the exit code is 3; a second Ctrl-C, or one while nothing is
    computed that could be kept, raises `KeyboardInterrupt`.

    Parameters
    ----------
    arguments : list of str, optional
        What follows the program's name, ``["trace", "fig12"]``; by default that of this process.

    Returns
    -------
    int
        The exit code: 0 done; 1 the results could not be written; 2 usage or input error; 3 stopped early.

    Examples
    --------
    >>> import arclen
    >>> arclen.main(["check", "fig12", "--elements", "0"])      # says why, on standard error
    2
    """
    if arguments is None:
        arguments = sys.argv[1:]
    if isinstance(arguments, (str, bytes)):
        raise TypeError(f"arguments: {arguments!r} is not a list of words")
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    return _arclen.run_command(["arclen", *(os.fspath(word) for word in arguments)])


def command() -> None:
    """The command: signals as the program takes them, and the process ends."""

    def ask(number: int, frame: Any) -> None:
        raise KeyboardInterrupt

    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, ask)
    try:
        code = main()
    except KeyboardInterrupt:
        # a second request, or nothing to keep: what is computed still is not waited for
        os._exit(130)
    sys.exit(code)
