#!/usr/bin/env python3
"""Tests that Doxygen reads the promised headers (include/palpate) without a warning: every class, function,
member and enumeration is documented, and if one parameter is, all are.  Also tests that the check can fail.

    reference_test.py       exits 77 (skipped, with a message) if Doxygen is missing
"""
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]
FOLDER = "packaging/reference"
sys.path.insert(0, str(TREE / FOLDER))
sys.dont_write_bytecode = True
from split_declarations import filtered  # noqa: E402

HEADER = """#pragma once
namespace palpate {
/// A length.
struct Length {
  double value = 0.0;  ///< [m]
};
/// Adds.  @param a  one  @param b  other
Length add(Length a, Length b);
}  // namespace palpate
"""


def warnings_of(tree, output):
    settings = (tree / FOLDER / "Doxyfile").read_text() + f"\nOUTPUT_DIRECTORY = {output}\n"
    done = subprocess.run(["doxygen", "-"], input=settings, cwd=tree, capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return done.stderr.splitlines()  # Doxygen prints only warnings


class Reference(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="palpate-reference-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def test_every_promised_header_is_documented(self):
        self.assertEqual(warnings_of(TREE, self.folder), [])
        pages = {page.name for page in (self.folder / "html").glob("*.html")}
        self.assertGreater(len(pages), 200)
        for page in ("classpalpate_1_1fem_1_1SoftBody.html", "structpalpate_1_1loop_1_1World.html",
                     "classpalpate_1_1device_1_1Device.html", "namespacepalpate_1_1integrate.html"):
            self.assertIn(page, pages)

    def planted(self, old, new):
        """Returns the warnings for a tree with one header, in which `old` is replaced by `new`."""
        tree = self.folder / "tree"
        header = tree / "include/palpate/core/length.h"
        header.parent.mkdir(parents=True, exist_ok=True)
        header.write_text(HEADER.replace(old, new))
        if not (tree / FOLDER).exists():
            shutil.copytree(TREE / FOLDER, tree / FOLDER)
        return warnings_of(tree, self.folder / "planted")

    def test_what_is_not_documented_is_found(self):
        self.assertEqual(self.planted("", ""), [])
        for old, new, word in (("  ///< [m]", "", "value"), ("/// A length.\n", "", "Length"),
                               ("  @param b  other", "", "parameter 'b'"), ("@param b", "@param c", "c"),
                               ("  ///< [m]", "\n  int count() const;", "count")):
            with self.subTest(old=old, new=new):
                found = self.planted(old, new)
                self.assertTrue(any(word in line for line in found), found)

    def test_a_comment_on_several_declarations_is_of_all(self):
        self.assertEqual(filtered("  double a = 0.0, b = 1.0;  ///< both\n"),
                         "  double a = 0.0;  /**< both */   double b = 1.0;  /**< both */\n")
        self.assertEqual(filtered("/// both\nint a = 0, b = 0;\n"),
                         "/// both\nint a = 0; int b = 0;  /**< both */\n")
        for text in ("int f(int a, int b);  ///< no\n", "  return a, b;\n", "double a, b;\n",
                     "  enum class E { kA, kB };\n"):
            with self.subTest(text):
                self.assertEqual("/**<" in filtered(text), False)
        self.assertEqual(filtered("int f(int a, int b);\n"), "int f(int a, int b);\n")


if __name__ == "__main__":
    if shutil.which("doxygen") is None:
        print("SKIPPED: doxygen is missing (Debian package doxygen)")
        sys.exit(77)
    unittest.main()
