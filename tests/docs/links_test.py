#!/usr/bin/env python3
"""Every link, anchor and picture of README.md and docs/ has a target, every page is reached, and the
navigation of the site and `palpate help` include all pages; faulty examples show that the checks detect
errors."""
import re
import statistics
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from pages import DOCS, TREE, anchors, fences, links, pages, prose, sentences  # noqa: E402


def broken(name, text, texts):
    """Returns the links of a page without a target. `texts`: all pages, by name."""
    out = []
    for target in links(text):
        if re.match(r"[a-z]+://|mailto:", target):
            continue
        path, _, fragment = target.partition("#")
        file = (TREE / name).parent / path if path else TREE / name
        if path and not file.exists():
            out.append(f"{name}: {target}: there is no such file")
        elif path and name.startswith("docs/") and not file.resolve().is_relative_to(DOCS):
            out.append(f"{name}: {target}: not under docs/, where the site ends")
        elif fragment:
            page = file.resolve().relative_to(TREE).as_posix()
            if fragment not in anchors(texts.get(page, "") if path else text):
                out.append(f"{name}: {target}: there is no such heading")
    return out


class Links(unittest.TestCase):
    def test_all_lead_somewhere(self):
        texts = pages()
        self.assertGreater(len(texts), 15)
        self.assertGreater(sum(len(links(text)) for text in texts.values()), 80)
        self.assertEqual([line for name, text in texts.items() for line in broken(name, text, texts)], [])

    def test_a_broken_link_is_found(self):
        texts = {**pages(), "docs/bad.md": "# Bad\n"}
        for text, found in (("[a](gone.md)", 1), ("[a](keys.md#no-such-heading)", 1), ("[a](#bad)", 0),
                            ("![p](scenes/gone.png)", 1), ("[a](../README.md)", 1), ("[a](keys.md)", 0),
                            ("[a](https://example.org/x)", 0), ("`[a](gone.md)`", 0)):
            with self.subTest(text=text):
                self.assertEqual(len(broken("docs/bad.md", "# Bad\n" + text + "\n", texts)), found)

    def test_headings_of_a_page_differ(self):
        for name, text in pages().items():
            names = anchors(text)
            self.assertEqual(len(names), len(set(names)), name)

    def test_every_page_begins_with_its_title(self):
        for name, text in pages().items():
            self.assertRegex(text, r"\A# \S", name)
            self.assertEqual(len(re.findall(r"^# ", prose(text), re.M)), 1, name)


class Lists(unittest.TestCase):
    """Every page of docs/ is in the index and in the navigation of the site. All but docs/theory are in
    `palpate help`."""
    names = {file.relative_to(DOCS).with_suffix("").as_posix() for file in DOCS.rglob("*.md")}
    theory = {name for name in names if name.startswith("theory/")}

    def test_index_has_every_page(self):
        linked = {target.partition("#")[0].removesuffix(".md")
                  for target in links((DOCS / "index.md").read_text())
                  if target.partition("#")[0].endswith(".md")}
        self.assertEqual(self.names - {"index"}, linked)

    def test_navigation_of_the_site_has_every_page(self):
        listed = re.findall(r"(\S+)\.md\s*$", (TREE / "mkdocs.yml").read_text(), re.M)
        self.assertEqual(sorted(listed), sorted(self.names))

    def test_help_has_every_page_but_theory(self):
        text = (TREE / "src/cli/CMakeLists.txt").read_text()
        listed = re.search(r"set\(PALPATE_PAGES ([^)]*)\)", text).group(1).split()
        self.assertEqual(sorted(listed), sorted(self.names - self.theory - {"index"}))

    def test_every_theory_page_is_linked_from_the_design_page(self):
        linked = {target.partition("#")[0].removesuffix(".md")
                  for target in links((DOCS / "design.md").read_text())}
        self.assertGreaterEqual(len(self.theory), 10)
        self.assertEqual(self.theory - linked, set())


class Short(unittest.TestCase):
    """The pages for new users must remain short."""

    def test_readme_is_short(self):
        self.assertLess(len((TREE / "README.md").read_text().splitlines()), 160)

    def test_first_pages_have_short_sentences(self):
        for name in ("README.md", "docs/first-touch.md", "docs/writing-scenes.md"):
            lengths = [len(sentence) for sentence in sentences((TREE / name).read_text())]
            self.assertGreater(len(lengths), 25, name)
            self.assertLessEqual(statistics.median(lengths), 15, name)

    def test_sentences_are_counted(self):
        text = ("# A heading\n\nOne two three. Four five\nsix seven: eight nine.\n\n"
                "- `Ten` is [an item](x.md).\n"
                "\n| a | b c d |\n\n```sh\nnot this one\n```\n")
        self.assertEqual([len(one) for one in sentences(text)], [3, 6, 4])


class Quotes(unittest.TestCase):
    def test_the_examples_of_extending_are_their_files(self):
        quoted = [text for language, text in fences((DOCS / "extending.md").read_text()) if language == "cpp"]
        files = [file.read_text() for file in sorted((TREE / "tests/docs/examples").glob("*.cpp"))]
        self.assertEqual(len(files), 5)
        self.assertEqual(sorted(quoted), sorted(files))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
