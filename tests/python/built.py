"""Common start of the tests of this folder: the built package on the path, the program next to it.

    X_test.py BUILD PROGRAM     exits with 77 (skipped) without arguments: built without Python
"""
import subprocess
import sys
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]
SCENES = TREE / "scenes"

if len(sys.argv) < 3:
    print("SKIPPED: built without PALPATE_WITH_PYTHON, or without tools")
    sys.exit(77)
BUILD, PROGRAM = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
PACKAGE = BUILD / "python"
sys.path.insert(0, str(PACKAGE))
import palpate  # noqa: E402,F401  before NumPy, which would load OpenBLAS with other settings


def run_program(*arguments):
    """Returns the output of the program."""
    done = subprocess.run([str(PROGRAM), *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(done.stdout + done.stderr)
    return done.stdout


def refusal_of_program(*arguments):
    """Returns the program's message when it rejects something."""
    done = subprocess.run([str(PROGRAM), *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode == 0:
        raise AssertionError("not refused: " + done.stdout)
    return done.stderr
