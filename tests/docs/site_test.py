#!/usr/bin/env python3
"""docs/ is one static site: `mkdocs build --strict`, which fails on a page or link that is not there.  Exits
with 77 (skipped, aloud) where MkDocs or its theme is missing."""
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]

if not shutil.which("mkdocs"):
    print("skipped: mkdocs is missing (Debian package mkdocs-material)")
    sys.exit(77)
with tempfile.TemporaryDirectory() as folder:
    site = Path(folder) / "site"
    command = ["mkdocs", "build", "--strict", "--config-file", TREE / "mkdocs.yml", "--site-dir", site]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if "Unrecognised theme name" in done.stderr:
        print("skipped: the theme is missing (Debian package mkdocs-material)")
        sys.exit(77)
    print(done.stdout + done.stderr)
    made = {page.parent.name for page in site.rglob("index.html") if page.parent != site}
    missing = {page.stem for page in (TREE / "docs").glob("*.md")} - made - {"index"}
    if done.returncode == 0 and missing:
        sys.exit(f"not in the site: {sorted(missing)}")
    sys.exit(done.returncode)
