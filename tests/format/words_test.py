#!/usr/bin/env python3
"""Comments of the C++ sources use the field's words: few lines begin with "Of" or "What", rates are written
with "per", and words that were private to this project do not come back.

    words_test.py [FOLDER...]      checks src, include, validation, benchmarks, examples and tests by default
"""
import re
import sys
import unittest
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]
FOLDERS = ("src", "include", "validation", "benchmarks", "examples", "tests")
SUFFIXES = (".h", ".cpp", ".inl")

COMMENT = re.compile(r"(?:^|\s)//[/!]?<?\s?(.*)")
FRAGMENT = re.compile(r"(of|what)\b", re.I)
MOST_FRAGMENTS = 0.005  # share of comment lines

QUANTITY = r"(?:one|two|three|four|six|eight|ten|once|twice|\d+(?:,\d{3})*(?:\.\d+)?(?: bytes| numbers)?)"
COUNTED = (r"(?:node|line|tick|step|query|point|thread|body|hand|tool|pair|period|contact|sample|row|vertex|"
           r"block|second|cluster|exchange|element|record|part|file)")
FOR_PER = re.compile(rf"\b{QUANTITY} an? {COUNTED}\b", re.I)

# Word -> the field's word.
PRIVATE = {
    r"bunch(?:es)?": "sample cluster",
    r"rungs?": "level of a refinement sequence",
    r"went through unseen": "tunnelled",
    r"to the last bit": "bitwise",
    r"at no price": "without cost",
    r"held against": "compared with",
    r"own error": "reference error",
    r"gives? up": "fails, stops",
    r"lets? go": "releases",
    r"hears?": "receives",
}
PRIVATE_WORD = re.compile(rf"\b(?:{'|'.join(PRIVATE)})\b", re.I)


def comments(folders):
    """Yields place and text of each comment line."""
    for folder in folders:
        for path in sorted((TREE / folder).rglob("*")):
            if path.suffix not in SUFFIXES:
                continue
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                match = COMMENT.search(line)
                if match:
                    yield f"{path.relative_to(TREE)}:{number}", match.group(1)


def fragments(lines):
    return [f"{place}: {text}" for place, text in lines if FRAGMENT.match(text)]


def wrong_words(lines):
    return [f"{place}: {text}" for place, text in lines
            if FOR_PER.search(text) or PRIVATE_WORD.search(text)]


class Words(unittest.TestCase):
    folders = FOLDERS

    @classmethod
    def setUpClass(cls):
        cls.lines = list(comments(cls.folders))

    def test_few_lines_begin_with_of_or_what(self):
        self.assertGreater(len(self.lines), 10_000)
        found = fragments(self.lines)
        self.assertLessEqual(len(found), MOST_FRAGMENTS * len(self.lines), "\n" + "\n".join(found))

    def test_words_of_the_field(self):
        self.assertEqual(wrong_words(self.lines), [])


class Planted(unittest.TestCase):
    def test_detects(self):
        for text in ("Pose of the tool, one a tick.", "36 bytes a block", "The body hears of it.",
                     "Own error", "A bunch of samples"):
            with self.subTest(text):
                self.assertEqual(len(wrong_words([("a.h:1", text)])), 1)
        for text in ("Of the tool, in world axes", "What a run came to"):
            with self.subTest(text):
                self.assertEqual(len(fragments([("a.h:1", text)])), 1)

    def test_accepts(self):
        for text in ("One pose per tick.", "Presses a body", "Whatever the order", "Offset of the piece"):
            with self.subTest(text):
                self.assertEqual(wrong_words([("a.h:1", text)]) + fragments([("a.h:1", text)]), [])


if __name__ == "__main__":
    if len(sys.argv) > 1:
        Words.folders = tuple(sys.argv[1:])
    unittest.main(argv=sys.argv[:1])
