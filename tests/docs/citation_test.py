#!/usr/bin/env python3
"""CITATION.cff agrees with the project: its version is that of CMakeLists.txt, its license that of README.md;
the check itself can fail."""
import re
import unittest
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]
CITATION = (TREE / "CITATION.cff").read_text()


def field(text, name):
    """Returns the value of a top-level field on one line, without quotes; None where there is none."""
    match = re.search(rf"^{name}: *(['\"]?)(.+?)\1 *$", text, re.M)
    return match and match.group(2)


def version_of_project():
    text = (TREE / "CMakeLists.txt").read_text()
    return re.search(r"^project\(palpate VERSION ([\d.]+)", text, re.M).group(1)


class Citation(unittest.TestCase):
    def test_version_is_that_of_the_project(self):
        self.assertEqual(field(CITATION, "version"), version_of_project())

    def test_license_is_that_of_the_readme(self):
        stated = re.search(r"License: (\S+)\.$", (TREE / "README.md").read_text(), re.M).group(1)
        self.assertEqual(field(CITATION, "license"), stated)

    def test_required_fields_are_there(self):
        self.assertEqual(field(CITATION, "cff-version"), "1.2.0")
        for name in ("message", "title"):
            self.assertTrue(field(CITATION, name), name)
        self.assertRegex(CITATION, r"(?m)^authors:\n  - ")

    def test_other_versions_are_found(self):
        other = re.sub(r"(?m)^version: .*$", "version: 9.9", CITATION)
        self.assertEqual(field(other, "version"), "9.9")
        self.assertEqual(field('version: "1.2"\n', "version"), "1.2")
        self.assertIsNone(field("cff-version: 1.2.0\n", "version"))


if __name__ == "__main__":
    unittest.main()
