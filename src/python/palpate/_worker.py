"""A comparison in a process of its own: `python -m palpate._worker FOLDER`, its order as JSON on stdin.

Each run of a comparison has a process, forked from one without threads (core/process_pool.h).  A session of
Python has some as soon as it has stepped on several, drawn, or is a notebook; this process has none.
"""
import json
import sys

from . import _palpate


def main() -> None:
    order = json.load(sys.stdin)
    try:
        scene = _palpate.Scene.parse(order["text"], order["path"], order["changes"])
        answer = _palpate.compare_into(sys.argv[1], scene, **order["options"])
    except _palpate.Error as error:
        answer = {"error": str(error)}
    json.dump(answer, sys.stdout)


if __name__ == "__main__":
    main()
