#!/usr/bin/env python3
"""Every key, option, command, name and file that README.md and docs/ mention exists, and every command and
option, every key and every name of the program occurs in some page; faulty examples show that the checks
detect errors.

The existing names are read from docs/keys.md, docs/names.md and docs/commands.md, which docs.generated_pages
compares with the program.
"""
import fnmatch
import re
import sys
import tomllib
import unittest
from functools import cache
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from pages import DOCS, GENERATED, TREE, fences, hand_written, pages, prose, spans, table_rows  # noqa: E402

LAUNCHER = {"test": {"--slow", "--part", "--help"}, "build": set(), "package": set(), "wheel": set()}
LAUNCHER_OPTIONS = {"--no-install", "--assume-packages", "--debug", "--asan", "--strict", "--minimal"}
# Options of other programs that the pages mention.
FOREIGN = {"--install", "--prefix"}
FOREIGN_NAMES = {"m_specifications",  # CHAI3D's
                 "snake_case", "p_WQ", "f_W"}  # in the conventions of CONTRIBUTING.md
# [hand.tool] and [hand.device] have the keys of [tool] and [device].
SAME_KEYS = {"hand.tool": "tool", "hand.device": "device"}


class Program:
    """Names and options according to the generated pages."""

    def __init__(self):
        self.options = {}
        commands = (DOCS / "commands.md").read_text()
        for name, text in re.findall(r"^## palpate ?(\S*)\n\n```text\n(.*?)^```$", commands, re.M | re.S):
            lines = re.findall(r"^  (-[\w,-]+)", text.partition("Options:")[2], re.M)
            self.options[name] = {option for line in lines for option in line.split(",")}
        everywhere = self.options.pop("")
        for name in self.options:
            self.options[name] |= everywhere
        rows = table_rows((DOCS / "keys.md").read_text())
        self.keys = {f"{table}.{cells[0].strip('`')}" for table, cells in rows if len(cells) == 7}
        studies = table_rows((DOCS / "study-keys.md").read_text())
        self.keys |= {f"{table}.{cells[0].strip('`')}" for table, cells in studies if len(cells) == 6}
        self.tables = {key.rpartition(".")[0] for key in self.keys}
        self.lists = {}
        for name, cells in table_rows((DOCS / "names.md").read_text()):
            if cells[0].startswith("`"):
                self.lists.setdefault(name, set()).add(cells[0].strip("`"))
        self.names = set().union(*self.lists.values())

    def has_key(self, path):
        path = re.sub(r"\.\d+(?=\.|$)", "", path)
        for other, same in SAME_KEYS.items():
            if path.startswith(other + "."):
                path = same + path[len(other):]
        return path in self.keys or path in self.tables


@cache
def sources():
    """All text of the sources, in which a name that is no key may occur."""
    folders = ("src", "include", "tests", "validation", "benchmarks", "shaders", "examples")
    files = [file for folder in folders for file in (TREE / folder).rglob("*")
             if file.suffix in (".h", ".cpp", ".py", ".txt", ".inl", ".glsl", ".comp")]
    files += [TREE / "CMakeLists.txt", TREE / "palpate", TREE / ".packages"]
    own = Path(__file__).parent
    files = [file for file in (*files, *(TREE / "scenes").glob("*.toml")) if file.parent != own]
    return "\n".join(file.read_text(encoding="utf-8", errors="replace") for file in files)


def command_faults(line, program):
    """Returns the faults of a `palpate ...` command."""
    words = re.sub(r"^(\./)?palpate\s*", "", line).split()
    while words and words[0] in LAUNCHER_OPTIONS:
        words.pop(0)
    if not words or words[0].startswith("-") or words[0].isupper() or words[0] == "...":
        return [f"option {word}" for word in words if word.startswith("--") and word not in
                LAUNCHER_OPTIONS | {"--help", "--version", "--quiet", "--verbose"}]
    command, rest = words[0], words[1:]
    known = {**program.options, **LAUNCHER}.get(command)
    if known is None:
        return [f"command {command}"]
    out = [f"option {word} of {command}" for word in rest if re.match(r"--?[a-z]", word)
           and word.partition("=")[0] not in known]
    for before, word in zip(rest, rest[1:]):
        if before == "--set" and "=" in word and not word.isupper():
            if not program.has_key(word.partition("=")[0]):
                out.append(f"key {word}")
        if before == "--integrator" and not word.isupper():
            if word not in program.lists["integrators"]:
                out.append(f"integrator {word}")
    first = next((word for word in rest if not word.startswith("-")), "")
    lists = {*program.lists, "keys", "study-keys"}
    if command == "list" and first and not first.isupper() and first not in lists:
        out.append(f"list {first}")
    if command == "validate":
        out += [f"case {word}" for word in rest if re.fullmatch(r"[a-z]+(-[a-z]+)*", word)
                and word not in program.lists["cases"] and rest[max(0, rest.index(word) - 1)] != "-o"]
    if command == "help" and first and not first.isupper() and not (DOCS / f"{first}.md").exists():
        out.append(f"topic {first}")
    if command == "run" and re.fullmatch(r"[a-z]+(-[a-z]+)*", first) and first not in program.lists["scenes"]:
        out.append(f"scene {first}")
    return out


def commands_of(text):
    """Returns each `palpate ...` of fenced blocks and of backticks."""
    out = []
    for language, content in fences(text):
        if language in ("sh", "text"):
            lines = re.sub(r"\s*\\\n\s*", " ", content).splitlines()
            out += [line.partition("   ")[0] for line in lines if re.match(r"(\./)?palpate ", line)]
    return out + [span for span in spans(text) if re.match(r"(\./)?palpate ", span)]


def toml_keys(value, path=""):
    for key, item in value.items():
        here = f"{path}.{key}" if path else key
        for one in item if isinstance(item, list) else [item]:
            if isinstance(one, dict):
                yield from toml_keys(one, here)
        if not isinstance(item, dict) and not (isinstance(item, list) and item and isinstance(item[0], dict)):
            yield here


def toml_faults(text, program):
    out = []
    for language, content in fences(text):
        if language == "toml":
            out += [f"key {key}" for key in toml_keys(tomllib.loads(content)) if not program.has_key(key)]
    return out


def span_faults(span, program):
    """Returns the faults of text in backticks."""
    if re.match(r"(\./)?palpate ", span):
        return []
    every_option = set().union(*program.options.values(), *LAUNCHER.values(), LAUNCHER_OPTIONS, FOREIGN)
    if span.startswith("--"):
        out = [f"option {word}" for word in re.findall(r"(?<!\S)--[a-z][a-z0-9-]*", span)
               if word not in every_option]
        setting = re.match(r"--set ([\w.]+)=", span)
        if setting and not program.has_key(setting.group(1)) and "youngs_module_pa" not in span:
            out.append(f"key {setting.group(1)}")
        return out
    if re.search(r"\b(PART|NAME)\b|_NAME", span) or span in FOREIGN_NAMES:
        return []
    if re.match(r"(src|tests|include|scenes|validation|docs|benchmarks|shaders|examples)/[\w./-]*$", span):
        return [] if (TREE / span).exists() else [f"file {span}"]
    dotted = re.match(r"([a-z_]+(?:\.\w+)+)(?: = .*)?$", span)
    if dotted and dotted.group(1).split(".")[0] in {table.split(".")[0] for table in program.tables}:
        name = dotted.group(1)
        return [] if program.has_key(name) or name in sources() else [f"key {name}"]
    table = re.fullmatch(r"\[+([a-z_.]+)\]+", span)
    if table and "." not in table.group(1)[:1]:
        known = program.tables | set(SAME_KEYS) | {"x", "hand"}
        return [] if table.group(1) in known else [f"table {span}"]
    setting = re.match(r"([a-z]\w*) = ", span)
    if setting:
        name = setting.group(1)
        known = any(key.rpartition(".")[2] == name for key in program.keys)
        return [] if known or re.search(rf"\b{name}\b", sources()) else [f"key {name}"]
    if re.fullmatch(r"[a-z]\w*(_\w+)+", span):  # a key, a column, a name of the sources
        return [] if re.search(rf"\b{span}\b", sources()) else [f"name {span}"]
    if re.fullmatch(r"[a-z][a-z0-9.]*(-[a-z0-9*.]+)+", span):
        if any(fnmatch.fnmatch(name, span) for name in program.names):
            return []
        return [] if span in sources() or (DOCS / f"{span}.md").exists() else [f"name {span}"]
    return []


def faults(text, program):
    out = [fault for line in commands_of(text) for fault in command_faults(line, program)]
    out += toml_faults(text, program)
    return out + [fault for span in spans(text) for fault in span_faults(span, program)]


class FromThePages(unittest.TestCase):
    program = Program()

    def test_what_they_mention_exists(self):
        seen = 0
        for name, text in hand_written().items():
            with self.subTest(page=name):
                self.assertEqual(faults(text, self.program), [])
            seen += len(commands_of(text)) + len(spans(text))
        self.assertGreater(seen, 600)

    def test_what_does_not_exist_is_found(self):
        for text, fault in (
                ("`palpate rum press-ball`", "command rum"), ("`palpate run press-ball --trase`", "--trase"),
                ("```sh\n./palpate run press-ball \\\n    --trase\n```", "--trase"),
                ("```sh\n./palpate run pres-ball\n```", "scene pres-ball"),
                ("`palpate validate patch-tset`", "case patch-tset"),
                ("`palpate list intgrators`", "list intgrators"),
                ("`palpate run press-ball --set body.0.youngs_modulus=1`", "key body.0.youngs_modulus"),
                ("`palpate run press-ball --integrator cvode-bfd`", "integrator cvode-bfd"),
                ("`palpate help no-such-page`", "topic no-such-page"),
                ("`--no-such-option`", "--no-such-option"),
                ("`exchange.no_such_key`", "key exchange.no_such_key"),
                ("`no_such_key = 3`", "key no_such_key"),
                ("`no_such_name_m`", "name no_such_name_m"), ("`ark-drik-esdirk437`", "ark-drik-esdirk437"),
                ("`[body.mash]`", "table [body.mash]"),
                ("`src/no/such/file.cpp`", "file src/no/such/file.cpp"),
                ("```toml\n[[body]]\nmash = 3\n```", "key body.mash"),
                ("```toml\n[[sweep]]\nkye = 3\n```", "key sweep.kye"),
                ("```toml\n[[hand]]\n[hand.tool]\nmash = 3\n```", "key hand.tool.mash")):
            with self.subTest(text=text):
                found = faults(text, self.program)
                self.assertEqual(len(found), 1, found)
                self.assertIn(fault, found[0])

    def test_what_exists_is_not_found(self):
        text = ("`palpate run press-ball --set contact.1.method=image -o out/x` `--realtime` "
                "`exchange.scheme` `rtol = 1e-3` `force.csv` `ark-dirk-*` `[[body.region]]` "
                "`./palpate --asan test --part mesh`\n"
                "```toml\n[[hand]]\nname = 'left'\n[hand.tool.coupling]\nstiffness_n_m = 3.0\n```\n")
        self.assertEqual(faults(text, self.program), [])


class FromTheProgram(unittest.TestCase):
    """The generated pages contain tables of all names; the other pages must mention those that a user
    needs."""
    program = Program()

    def test_the_generated_pages_have_all(self):
        self.assertGreaterEqual(len(self.program.options), 14)
        self.assertGreater(sum(len(options) for options in self.program.options.values()), 60)
        self.assertGreater(len(self.program.keys), 160)
        self.assertGreaterEqual(len(self.program.lists), 15)
        self.assertGreater(len(self.program.names), 120)

    def test_every_command_is_shown_by_a_page_that_a_person_wrote(self):
        shown = {word for text in hand_written().values() for line in commands_of(text)
                 for word in re.sub(r"^(\./)?palpate\s*", "", line).split()[:1]}
        self.assertEqual(set(self.program.options) - shown, set())

    def test_every_key_of_the_specs_is_in_the_page(self):
        """A key's row is `name("key", ...`: no table of the loader may be missing."""
        text = "\n".join(file.read_text() for pattern in ("keys*.cpp", "study_keys.cpp")
                         for file in (TREE / "src/scene").glob(pattern))
        kinds = "number|numbers|text|texts|integer|boolean|vec3|table|tables|rungs|group"
        written = set(re.findall(rf"\b(?:{kinds})"
                                 r"\(\s*\"(\w+)\"", text))
        self.assertGreater(len(written), 120)
        known = {key.rpartition(".")[2] for key in self.program.keys} | self.program.tables
        self.assertEqual(written - known, set())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
