#!/usr/bin/env python3
"""docs/keys.md, docs/study-keys.md, docs/names.md and docs/commands.md equal the program's output.

    generated_pages_test.py PROGRAM            compares
    generated_pages_test.py PROGRAM --write    rewrites them: after a key, a name or an option has changed
"""
import re
import subprocess
import sys
import textwrap
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from pages import DOCS, fences  # noqa: E402

PROGRAM = Path(sys.argv[1]).resolve()
INTRODUCTION = """# Every command with every option

<!-- Made by tests/docs/generated_pages_test.py of `palpate COMMAND --help`; a test compares them. -->

`palpate COMMAND --help` prints these texts in a terminal. [running.md](running.md) and
[comparing.md](comparing.md) say when to use which. `./palpate test`, `./palpate build` and
`./palpate package` are the launcher's: `./palpate test --help` says what they take.
"""


def said(*arguments):
    done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, stdin=subprocess.DEVNULL,
                          timeout=120)
    return done.stdout if done.returncode == 0 else None


def wrapped(line, columns=108):
    """Breaks the help's long lines; continuation lines of an option are aligned with its text."""
    text_column = 34 if line.startswith("  ") else 0
    return textwrap.wrap(line, columns, subsequent_indent=text_column * " ", break_long_words=False,
                         break_on_hyphens=False, drop_whitespace=True) if len(line) > columns else [line]


def section(heading, text):
    lines = [part for line in text.strip().splitlines() for part in wrapped(line)]
    return f"\n## {heading}\n\n```text\n" + "\n".join(lines) + "\n```\n"


def commands():
    block = said("--help").partition("Subcommands:\n")[2].partition("\n\n")[0]
    return re.findall(r"^  (\S+)", block, re.M)


def optional_section(name):
    """Section of a program that not every build has (palpate-model, palpate-touch): otherwise the page's
    existing one."""
    text = said(name, "--help")
    if text is None:
        print(f"remark: this build has no palpate-{name}, its section is not compared")
        page = (DOCS / "commands.md").read_text()
        return re.search(rf"\n## palpate {name}\n.*?^```$\n", page, re.M | re.S).group()
    return section(f"palpate {name}", text)


def commands_page():
    sections = [optional_section(name) if name in ("model", "touch") else
                section(f"palpate {name}", said(name, "--help"))
                for name in commands()]
    return INTRODUCTION + section("palpate", said("--help")) + "".join(sections)


MADE = {"keys.md": lambda: said("list", "keys", "--markdown"),
        "study-keys.md": lambda: said("list", "study-keys", "--markdown"),
        "names.md": lambda: said("list", "--markdown"), "commands.md": commands_page}


class Generated(unittest.TestCase):
    maxDiff = None

    def test_pages_are_what_the_program_says(self):
        for name, make in MADE.items():
            with self.subTest(page=name):
                self.assertEqual((DOCS / name).read_text().splitlines(), make().splitlines(),
                                 f"docs/{name} is stale: {Path(__file__).name} PROGRAM --write")

    def test_they_have_all_of_it(self):
        self.assertGreaterEqual(len(commands()), 14)
        self.assertEqual(len(fences((DOCS / "commands.md").read_text())), len(commands()) + 1)
        keys = said("list", "keys")
        page = (DOCS / "keys.md").read_text()
        tables = re.findall(r"^\[([\w.]+)\]$", keys, re.M)
        self.assertGreater(len(tables), 20)
        for table in tables:
            self.assertIn(f"\n## {table}\n", page)
        # as many rows as the terminal's tables, without the header and the rule of each
        rows = [line for line in keys.splitlines() if line and not line.startswith("[")]
        self.assertEqual(len(re.findall(r"^\| `\w+` \|.*\|.*\|.*\|.*\|.*\|.*\|$", page, re.M)),
                         len(rows) - 2 * len(tables))

    def test_every_key_has_a_range_a_default_and_a_meaning(self):
        seen = 0
        for line in [*(DOCS / "keys.md").read_text().splitlines(),
                     *(DOCS / "study-keys.md").read_text().splitlines()]:
            if not re.match(r"\| `\w+` \|", line):
                continue
            cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
            _, kind, unit, bounds, default, meaning = cells[:6]
            self.assertTrue(kind and default and meaning, line)
            self.assertTrue(bounds or kind in ("table", "tables"), line)
            seen += 1
        self.assertGreater(seen, 170)


if __name__ == "__main__":
    if "--write" in sys.argv:
        for name, make in MADE.items():
            (DOCS / name).write_text(make(), encoding="utf-8")
            print("written:", DOCS / name)
    else:
        unittest.main(argv=sys.argv[:1])
