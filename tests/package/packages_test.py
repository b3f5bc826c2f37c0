#!/usr/bin/env python3
"""Tests that every entry of .packages is a package of this Debian release, and that apt-get needs no other
list.

    packages_test.py       exits 77 (skipped, with a message) if apt has no package lists
"""
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

LIST = Path(__file__).resolve().parents[2] / ".packages"


def entries():
    lines = (line.split("#")[0].strip() for line in LIST.read_text().splitlines())
    return [line for line in lines if line]


def output(*command):
    return subprocess.run(command, capture_output=True, text=True)


def lists_are_here():
    return shutil.which("apt-cache") is not None and any(Path("/var/lib/apt/lists").glob("*_Packages*"))


class Packages(unittest.TestCase):
    def test_list_is_well_formed(self):
        self.assertGreater(len(entries()), 20)
        self.assertEqual(len(entries()), len(set(entries())))
        for entry in entries():
            self.assertRegex(entry, r"^[a-z0-9][a-z0-9+.-]+$")
        section = []
        for line in LIST.read_text().splitlines() + ["#"]:
            if line.startswith("#"):
                self.assertEqual(section, sorted(section), "sections are alphabetical")
                section = []
            else:
                section.append(line)

    def test_every_entry_exists(self):
        policies = {}
        for line in output("apt-cache", "policy", *entries()).stdout.splitlines():
            if not line.startswith(" "):
                name = line.rstrip(":")
            elif "Candidate: " in line:
                policies[name] = line.split()[1]
        for entry in entries():
            with self.subTest(package=entry):
                self.assertIn(entry, policies)
                self.assertNotEqual(policies[entry], "(none)")

    def test_the_list_installs_on_a_system_with_nothing_installed(self):
        done = output("apt-get", "-o", "Dir::State::status=/dev/null", "install", "--simulate",
                      "--no-install-recommends", *entries())
        self.assertEqual(done.returncode, 0, done.stderr)
        installed = {line.split()[1] for line in done.stdout.splitlines() if line.startswith("Inst ")}
        self.assertEqual(set(entries()) - installed, set())


if __name__ == "__main__":
    if not lists_are_here():
        print("SKIPPED: apt has no package lists here (apt-get update fetches them)")
        sys.exit(77)
    unittest.main()
