#!/usr/bin/env python3
"""Every C++ source is formatted by clang-format (.clang-format: 110 columns), and no line of any other text
is longer; faulty examples show that the checks detect errors."""
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]
FOLDERS = ("include", "src", "tests", "validation", "benchmarks", "packaging", "examples", "cmake")
COLUMNS = 110
NAMES = (".h", ".cpp", ".inl", ".py", ".toml", ".cmake", ".in", "CMakeLists.txt", ".md", "palpate", ".ci/run",
         ".vert", ".frag", ".comp", ".glsl", ".js", ".mjs", ".cff", ".yml")
# Bundled libraries, and a maintainer's npm packages.
MADE_ELSEWHERE = ("src/report/page/dist/", "src/report/page/node_modules/", "src/live/page/dist/")


def version_wanted():
    """Returns the version of clang-format with which the sources are formatted: versions break some lines
    differently."""
    return re.match(r"# clang-format (\d+)", (TREE / ".clang-format").read_text()).group(1)


def misformatted(files):
    """Returns the files that clang-format would change."""
    if not shutil.which("clang-format"):
        raise unittest.SkipTest("clang-format is missing (Debian package clang-format)")
    here = subprocess.run(["clang-format", "--version"], capture_output=True, text=True, check=True).stdout
    version = re.search(r"version (\d+)", here).group(1)
    if version != version_wanted():
        raise unittest.SkipTest(f"clang-format {version_wanted()} (Debian 12) formats the sources; "
                                f"here is {version}")
    done = subprocess.run(["clang-format", "--style=file", "--dry-run", "-Werror", *map(str, files)],
                          capture_output=True, text=True, check=False)
    lines = (line.split(":")[0] for line in done.stderr.splitlines() if "clang-format-violations" in line)
    return sorted(set(lines))


def too_long(text, markdown=False):
    """Returns the numbers of lines that are too long, except for table rows, links and addresses in
    Markdown."""
    return [number for number, line in enumerate(text.splitlines(), 1) if len(line) > COLUMNS
            and not (markdown and (line.startswith(("|", "!", "<")) or "](" in line or "://" in line))]


class Format(unittest.TestCase):
    def test_lines(self):
        files = [path for top in (".", "docs", "scenes", "shaders", ".ci", ".github", *FOLDERS)
                 for path in ((TREE / top).glob("*") if top == "." else (TREE / top).rglob("*"))
                 if path.is_file() and path.as_posix().endswith(NAMES)
                 and not path.relative_to(TREE).as_posix().startswith(MADE_ELSEWHERE)]
        self.assertGreater(len(files), 600)
        self.assertEqual([f"{path.relative_to(TREE)}:{number}" for path in sorted(files)
                          for number in too_long(path.read_text(encoding="utf-8"), path.suffix == ".md")], [])

    def test_a_long_line_is_found(self):
        long = 111 * "x"
        self.assertEqual(too_long(f"{long}\n{long[1:]}\n"), [1])
        self.assertEqual(too_long(f"| {long}\n[a]({long})\n{long}\n", markdown=True), [3])

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
