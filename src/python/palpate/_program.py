"""The program palpate, which stands outside of this module."""
from __future__ import annotations

import os
import shutil
from pathlib import Path

from ._palpate import Error

PACKAGE = Path(__file__).absolute().parent


def program(caller: str) -> str:
    """Returns the path of the program: $PALPATE_PROGRAM, the one of this build, or the one on the path.

    `caller` is the function that needs it, for the message.  Raises Error if the program is missing.
    """
    named = os.environ.get("PALPATE_PROGRAM", "")
    built = PACKAGE.parents[1] / "bin" / "palpate"
    found = named or (str(built) if built.is_file() else shutil.which("palpate") or "")
    if not found or not os.path.exists(found):
        raise Error(f"{caller}: the program palpate is missing" + (f" ({named})" if named else "") +
                    "; install it, or set PALPATE_PROGRAM to its path, such as build/release/bin/palpate")
    return found


def error_of(output: str, command: str, status: int) -> Error:
    """Returns the error that the last line of the program's output states."""
    last = (output.strip().splitlines() or [f"{command} ended with status {status}"])[-1]
    for prefix in ("palpate: error: ", "palpate-model: error: ", "palpate-touch: error: "):
        last = last.removeprefix(prefix)
    return Error(last)
