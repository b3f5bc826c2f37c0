#!/usr/bin/env python3
"""The wheel is complete according to its RECORD, pip installs it without network, and the installation
runs."""
import base64
import csv
import hashlib
import importlib.util
import os
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

from built import BUILD, SCENES, TREE

sys.path.insert(0, str(TREE / "src/python"))
from make_wheel import make_wheel, tag  # noqa: E402

PIP_IS_HERE = importlib.util.find_spec("pip") is not None


def call(*command, **options):
    done = subprocess.run([str(piece) for piece in command], capture_output=True, text=True, check=False,
                          **options)
    if done.returncode != 0:
        raise AssertionError(done.stdout + done.stderr)
    return done.stdout


class Wheel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="palpate-wheel-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        cls.content = cls.folder / "content"
        call("cmake", "--install", BUILD, "--component", "wheel", "--prefix", cls.content)
        cls.wheel = make_wheel(cls.content, "0.1.0", TREE / "LICENSE", cls.folder)

    def test_its_name(self):
        python = f"cp{sys.version_info.major}{sys.version_info.minor}"
        self.assertRegex(self.wheel.name, rf"^palpate-0\.1\.0-{python}-{python}-linux_\w+\.whl$")

    def test_record_has_every_file_with_its_digest(self):
        with zipfile.ZipFile(self.wheel) as archive:
            rows = list(csv.reader(archive.read("palpate-0.1.0.dist-info/RECORD").decode().splitlines()))
            self.assertEqual(sorted(row[0] for row in rows), sorted(archive.namelist()))
            for name, digest, size in rows:
                if name.endswith("/RECORD"):
                    self.assertEqual((digest, size), ("", ""))
                    continue
                content = archive.read(name)
                wanted = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode().rstrip("=")
                self.assertEqual((digest, size), ("sha256=" + wanted, str(len(content))), name)
        names = {name for name, *_ in rows}
        self.assertLessEqual({"palpate/__init__.py", "palpate/py.typed", "palpate/_palpate.pyi",
                              "palpate/plot.py", "palpate-0.1.0.dist-info/LICENSE"}, names)
        self.assertEqual(len([name for name in names if ".so" in name]), 5)

    def test_the_same_content_gives_the_same_bytes(self):
        again = self.folder / "again"
        again.mkdir()
        self.assertEqual(make_wheel(self.content, "0.1.0", TREE / "LICENSE", again).read_bytes(),
                         self.wheel.read_bytes())

    def test_nothing_in_it_needs_the_build(self):
        libraries = [file for file in (self.content / "palpate").glob("*.so*") if not file.is_symlink()]
        self.assertEqual(len(libraries), 5)
        for library in libraries:
            dynamic = call("readelf", "-d", library)
            self.assertNotIn(str(TREE), dynamic, library.name)
            self.assertIn("$ORIGIN", dynamic, library.name)

    def test_it_is_installed_and_runs(self):
        target = self.folder / "site"
        clean = {key: value for key, value in os.environ.items()
                 if key not in ("PYTHONPATH", "LD_LIBRARY_PATH")}
        if PIP_IS_HERE:
            call(sys.executable, "-m", "pip", "install", "--no-index", "--no-deps", "--no-compile",
                 "--disable-pip-version-check", "--target", target, self.wheel, env=clean)
        else:
            with zipfile.ZipFile(self.wheel) as archive:
                archive.extractall(target)
        code = ("import sys, palpate, importlib.metadata as m\n"
                "s = palpate.Simulation(palpate.load(sys.argv[1])); s.advance(0.1)\n"
                "print(palpate.__file__)\nprint(m.version('palpate'), round(s.time, 6))\n"
                "print(open('/proc/self/maps').read())")
        lines = call(sys.executable, "-B", "-c", code, SCENES / "press-ball.toml", cwd=self.folder,
                     env={**clean, "PYTHONPATH": str(target)}).splitlines()
        self.assertEqual(lines[0], str(target / "palpate" / "__init__.py"))
        self.assertEqual(lines[1], "0.1.0 0.1")
        loaded = {line.split()[-1] for line in lines[2:] if "palpate" in line}
        self.assertGreaterEqual(len(loaded), 5)
        for path in loaded:
            self.assertTrue(path.startswith(str(target)), path)

    @unittest.skipUnless(PIP_IS_HERE, "pip is missing (Debian package python3-pip)")
    def test_the_tag_is_pips(self):
        listed = call(sys.executable, "-m", "pip", "debug", "--verbose", "--disable-pip-version-check")
        self.assertIn(f"  {tag()}\n", listed)


if __name__ == "__main__":
    unittest.main(argv=[__file__])
