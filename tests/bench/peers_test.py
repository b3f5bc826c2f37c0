#!/usr/bin/env python3
"""Tests contact_peers on one state of two pumpkins: every library must return a result with contact.

    peers_test.py [CONTACT_PEERS PALPATE]      without them it exits 77 (skipped, with a message)

PALPATE builds the pumpkins' model, once, in the folder that PALPATE_MODELS specifies.
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

SCENE = Path(__file__).resolve().parents[2] / "scenes" / "two-pumpkins.toml"
LIBRARIES = ["palpate", "Bullet", "FCL", "CGAL"]


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{command[0]}: status {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def main():
    if len(sys.argv) < 3:
        print("SKIPPED: contact_peers is not built; configure with --preset benchmarks, where libbullet-dev, "
              "libfcl-dev and libcgal-dev are there")
        return 77
    peers, palpate = sys.argv[1:3]
    with tempfile.TemporaryDirectory(prefix="palpate-peers-") as folder:
        run(palpate, "run", SCENE, "--duration-s", "0.01", "-o", Path(folder) / "out")
        text = run(peers, "--once", SCENE)
    print(text)
    assert re.search(r", 1 states in contact, up to 1 rounds", text), "one state was asked for"
    for library in LIBRARIES:
        # LIBRARY  way  least / median / p99  ratio  contacts  deepest
        rows = re.findall(rf"(?m)^{library}\S* .*?([\d.]+) / ([\d.]+) / ([\d.]+) +([\d.]+) +(\d+) ", text)
        assert rows, f"{library} has no row"
        for least, median, p99, ratio, contacts in rows:
            assert 0.0 < float(least) <= float(median) <= float(p99), (library, least, median, p99)
            assert float(ratio) > 0.0 and int(contacts) > 0, (library, ratio, contacts)
    for library in LIBRARIES[1:]:
        assert re.search(rf"(?m)^  {library}\S*.*: its fastest way takes [\d.]+ times", text), library
    return 0


sys.exit(main())
