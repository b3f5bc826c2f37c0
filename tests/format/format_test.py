#!/usr/bin/env python3
"""Every C++ source is as clang-format writes it (.clang-format: 110 columns); the check itself can fail."""
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]
FOLDERS = ("include", "src", "tests", "validation", "benchmarks")


def misformatted(files):
    """The files that clang-format would change."""
    if not shutil.which("clang-format"):
        raise unittest.SkipTest("clang-format is missing (Debian package clang-format)")
    done = subprocess.run(["clang-format", "--style=file", "--dry-run", "-Werror", *map(str, files)],
                          capture_output=True, text=True, check=False)
    lines = (line.split(":")[0] for line in done.stderr.splitlines() if "clang-format-violations" in line)
    return sorted(set(lines))


class Format(unittest.TestCase):
    def test_tree(self):
        files = sorted(path for folder in FOLDERS for path in (TREE / folder).rglob("*")
                       if path.suffix in (".h", ".cpp", ".inl"))
        self.assertGreater(len(files), 500)
        self.assertEqual(misformatted(files), [])

    def test_a_bad_file_is_found(self):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copy(TREE / ".clang-format", folder)
            bad = Path(folder) / "bad.cpp"
            bad.write_text("int  main( ){return 0;}\n")
            good = Path(folder) / "good.cpp"
            good.write_text("int main() { return 0; }\n")
            self.assertEqual(misformatted([bad, good]), [str(bad)])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
