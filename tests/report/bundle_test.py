#!/usr/bin/env python3
"""The committed scripts of the page were built from the sources in the repository, are small, contain their
licences, and name no registry; faulty examples show that the checks detect errors."""
import hashlib
import json
import re
import sys
import unittest
from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "src/report/page"
LIVE = PAGE.parents[1] / "live/page"
MOST_BYTES = 700_000
PERMISSION = "The above copyright notice and this permission notice shall be included"
HOLDERS = {"page.js": ["Leon Sorokin"], "three.js": ["three.js authors"], "view.js": [], "viewer.js": []}
FOLDERS = {name: LIVE if name == "viewer.js" else PAGE for name in HOLDERS}


def hash_of(files):
    """Returns the hash as build.mjs computes it."""
    digest = hashlib.sha256()
    for content in files:
        digest.update(content)
    return digest.hexdigest()


def sources(folder):
    files = [PAGE / "build.mjs", PAGE / "package-lock.json", *sorted((folder / "src").iterdir())]
    return [path.read_bytes() for path in files]


def bundle(name):
    return (FOLDERS[name] / "dist" / name).read_text("utf-8")


def problems(name, text, expected_hash):
    found = []
    if expected_hash not in text[:300]:
        found.append(f"{name} was not made of the sources beside it: npm ci && npm run build")
    for holder in HOLDERS[name]:
        if holder not in text or PERMISSION not in text:
            found.append(f"{name} lacks the licence of {holder}")
    if re.search(r"</script|<!--|]]>", text, re.IGNORECASE):
        found.append(f"{name} would end the element that holds it")
    if re.search(r"\b(fetch|XMLHttpRequest|WebSocket)\s*\(\s*[\"']https?:", text):
        found.append(f"{name} asks the network")
    return found


class Bundle(unittest.TestCase):
    def test_bundles(self):
        for name in HOLDERS:
            with self.subTest(name):
                self.assertEqual(problems(name, bundle(name), hash_of(sources(FOLDERS[name]))), [])

    def test_page_and_style_are_copies(self):
        for name in ("viewer.html", "viewer.css"):
            with self.subTest(name):
                self.assertEqual((LIVE / "dist" / name).read_bytes(), (LIVE / "src" / name).read_bytes())

    def test_size(self):
        sizes = {name: len(bundle(name)) for name in HOLDERS}
        for name, holders in HOLDERS.items():  # three.js stands in one file only
            self.assertEqual(sizes[name] > 60_000, bool(holders), name)
        self.assertLess(sum(sizes.values()), MOST_BYTES)

    def test_licences(self):
        text = (PAGE / "dist/LICENSES.txt").read_text("utf-8")
        self.assertEqual(text.count(PERMISSION), 2)
        for holders in HOLDERS.values():
            for holder in holders:
                self.assertIn(holder, text)

    def test_lock_file_pins_versions_and_names_no_host(self):
        text = (PAGE / "package-lock.json").read_text("utf-8")
        self.assertNotIn("://", text)
        packages = json.loads(text)["packages"]
        for name in ("three", "uplot", "esbuild"):
            self.assertTrue(packages[f"node_modules/{name}"]["integrity"].startswith("sha512-"))

    def test_what_is_wrong_is_found(self):
        good = f"/* {hash_of([b'x'])} */ Leon Sorokin {PERMISSION}"
        self.assertEqual(problems("page.js", good, hash_of([b"x"])), [])
        self.assertEqual(len(problems("page.js", good, hash_of([b"y"]))), 1)
        self.assertEqual(len(problems("page.js", good + "</SCRIPT>", hash_of([b"x"]))), 1)
        self.assertEqual(len(problems("three.js", good, hash_of([b"x"]))), 1)
        self.assertEqual(len(problems("page.js", good + " fetch('https://a')", hash_of([b"x"]))), 1)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
