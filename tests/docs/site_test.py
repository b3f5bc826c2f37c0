#!/usr/bin/env python3
"""docs/ is one static site: `mkdocs build --strict` fails on a missing page or link; in addition, every
anchor that a link refers to must exist. Exits with 77 (skipped, with a message) where MkDocs or its theme is
missing.
"""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]


def skip(what):
    print(f"skipped: {what} is missing (Debian package mkdocs-material)")
    sys.exit(77)


def lost_places(site):
    """Returns the links to headings that do not exist."""
    texts = {page: page.read_text(encoding="utf-8") for page in site.rglob("index.html")}
    out, seen = [], 0
    for page, text in texts.items():
        for target, place in re.findall(r'href="([^"#:]*)#([^"]+)"', text):
            there = (page.parent / target / "index.html").resolve() if target else page
            seen += 1
            if f'id="{place}"' not in texts.get(there, ""):
                out.append(f"{page.relative_to(site)}: {target}#{place}")
    if seen < 200:
        out.append(f"only {seen} links to places were found")
    return out


def check(site):
    """Returns the faults of the site; empty if there are none."""
    made = {page.parent.relative_to(site).as_posix() for page in site.rglob("index.html")}
    docs = TREE / "docs"
    missing = ({page.relative_to(docs).with_suffix("").as_posix() for page in docs.rglob("*.md")} - made
               - {"index"})
    return [f"not in the site: {name}" for name in sorted(missing)] + lost_places(site)


def main():
    if not shutil.which("mkdocs"):
        skip("mkdocs")
    with tempfile.TemporaryDirectory() as folder:
        site = (Path(folder) / "site").resolve()
        command = ["mkdocs", "build", "--strict", "--config-file", TREE / "mkdocs.yml", "--site-dir", site]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
        if "Unrecognised theme name" in done.stderr:
            skip("its theme")
        print(done.stdout + done.stderr)
        if done.returncode != 0:
            sys.exit(done.returncode)
        faults = check(site)
        page = site / "keys/index.html"  # the check must detect a planted fault
        page.write_text(page.read_text().replace('id="bodymesh"', ""))
        if not any("#bodymesh" in fault for fault in check(site)):
            faults.append("a heading that was taken away was not missed")
        sys.exit("\n".join(faults) or 0)


main()
