#!/usr/bin/env python3
"""Tests the Debian packages on an empty Debian system: built by `cpack`, installed by apt on a root created
by debootstrap, and run there by an unprivileged user in an empty folder.

    clean_root_test.py BUILD     exits 77 (skipped, with a message) without root, debootstrap, private mounts

It takes minutes and needs the network: the mirror for which apt is configured on this machine.
"""
import gzip
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
TREE = HERE.parents[1]
BUILD = Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else None
USER = 1000


def output(*command, **options):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)


def must(*command, **options):
    done = output(*command, **options)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}\n{(done.stdout + done.stderr)[-4000:]}")
    return done.stdout


def release():
    """Returns the name of this Debian release, for which the packages are built."""
    return re.search(r"^VERSION_CODENAME=(\w+)", Path("/etc/os-release").read_text(), re.M).group(1)


def mirror():
    """Returns the mirror from which apt on this machine gets this release; None if there is none."""
    lines = output("apt-get", "indextargets", "--format", "$(SITE) $(CODENAME) $(COMPONENT)",
                   "Identifier: Packages").stdout.splitlines()
    sites = [line.split()[0] for line in lines if line.split()[1:] == [release(), "main"]]
    return sites[0].rstrip("/") if sites else None


def missing():
    """Returns the reason why this test cannot run here; empty if it can."""
    if os.geteuid() != 0:
        return "it needs root, for debootstrap and chroot"
    for program, package in (("debootstrap", "debootstrap"), ("dpkg-shlibdeps", "dpkg-dev")):
        if shutil.which(program) is None:
            return f"{program} is missing (Debian package {package})"
    if output("unshare", "--mount", "--pid", "--fork", "true").returncode != 0:
        return "no mounts of one's own are allowed here (unshare --mount)"
    if mirror() is None:
        return "apt has no package lists of this release (apt-get update fetches them)"
    return ""


class Root:
    """Folder with an empty Debian system.  Nothing remains mounted: each command has a private /proc."""

    def __init__(self, folder):
        self.folder = folder
        proxy = output("apt-config", "shell", "P", "Acquire::http::Proxy").stdout
        address = re.search(r"P='(.*)'", proxy)
        self.proxy = address.group(1) if address else ""
        environment = dict(os.environ, **({"http_proxy": self.proxy} if self.proxy else {}))
        must("debootstrap", "--variant=minbase", release(), folder, mirror(), env=environment)
        if self.proxy:
            (folder / "etc/apt/apt.conf.d/proxy").write_text(f'Acquire::http::Proxy "{self.proxy}";\n')
        home = folder / "home/user"
        home.mkdir(parents=True)
        os.chown(home, USER, USER)

    def command(self, words, user=None, folder="/"):
        identity = ["--userspec", f"{user}:{user}"] if user else []
        home = "/home/user" if user else "/root"
        inside = ["env", "-i", "PATH=/usr/sbin:/usr/bin:/sbin:/bin", f"HOME={home}", "LC_ALL=C.UTF-8",
                  "DEBIAN_FRONTEND=noninteractive", "sh", "-c", 'cd "$0" && exec "$@"', folder, *words]
        return ["unshare", "--mount", "--pid", "--fork", f"--mount-proc={self.folder}/proc",
                "chroot", *identity, self.folder, *inside]

    def install(self, *packages):
        """Installs packages with their dependencies only: packages that apt recommends must not be needed."""
        return must(*self.command(["apt-get", "install", "--yes", "--no-install-recommends", *packages]))

    def run(self, *words, folder="/home/user"):
        return output(*self.command(words, USER, folder))


class CleanRoot(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="palpate-root-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.folder.chmod(0o755)
        packages = cls.folder / "packages"
        must("cpack", "--config", BUILD / "CPackConfig.cmake", "-B", packages, cwd=BUILD)
        found = sorted(packages.glob("*.deb"))
        cls.runtime = next(path for path in found if path.name.startswith("palpate_"))
        cls.library = next(path for path in found if path.name.startswith("libpalpate-dev_"))
        cls.root = Root(cls.folder / "root")
        for package in (cls.runtime, cls.library):
            shutil.copy(package, cls.folder / "root")
        cls.root.install(f"/{cls.runtime.name}")

    def field(self, package, name):
        return must("dpkg-deb", "--field", package, name).strip()

    def test_fields(self):
        depends = {word.split()[0] for word in self.field(self.runtime, "Depends").split(", ")}
        # names with an ABI version differ between Debian releases
        for package in ("libc6", r"libcholmod\d", r"libsimbody3\.7", r"libhdf5-\d[\d-]*", "libsqlite3-0",
                        "libcairo2", "libepoxy0", "libegl1", "libgl1-mesa-dri", "libopenblas0-pthread"):
            self.assertTrue(any(re.fullmatch(package + "(t64)?", name) for name in depends), package)
        # SUNDIALS, Qhull's archive and CGAL are linked in; users run no compiler
        self.assertFalse([name for name in depends if name.endswith("-dev") or "sundials" in name])
        version = self.field(self.runtime, "Version")
        self.assertIn(f"palpate (= {version})", self.field(self.library, "Depends"))
        self.assertRegex(self.field(self.runtime, "Maintainer"), r".+ <.+@.+>")
        self.assertEqual(self.field(self.runtime, "Section"), "science")
        self.assertIn("virtual spring", self.field(self.runtime, "Description"))

    def test_documents(self):
        documents = self.folder / "root/usr/share/doc/palpate"
        notice = (documents / "copyright").read_text()
        for name in ("GPL-3", "three.js authors", "Lawrence Livermore", "qhull", "CLI11", "Lohmann"):
            self.assertIn(name.lower(), notice.lower())
        self.assertIn("palpate (", gzip.decompress((documents / "changelog.Debian.gz").read_bytes()).decode())

    @unittest.skipUnless(shutil.which("lintian"), "lintian is missing")
    def test_lintian(self):
        done = output("lintian", "--allow-root", self.runtime, self.library)
        self.assertEqual([line for line in done.stdout.splitlines() if line[:2] in ("E:", "W:")], [])

    def test_validate_quick(self):
        done = self.root.run("palpate", "validate", "--quick")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"(\d+) of \1 cases meet their acceptance limits")

    def test_program_in_an_empty_folder(self):
        version = (BUILD / "CMakeCache.txt").read_text()
        number = re.search(r"^CMAKE_PROJECT_VERSION:STATIC=(.*)$", version, re.M).group(1)
        self.assertIn(f"palpate {number} ", self.root.run("palpate", "--version").stdout)
        scenes = self.root.run("palpate", "list", "scenes").stdout
        for scene in (TREE / "scenes").glob("*.toml"):
            self.assertIn(scene.stem, scenes)
        self.assertIn("libpalpate-dev", self.root.run("palpate", "help", "installing").stdout)
        done = self.root.run("palpate", "run", "falling-ball")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((self.folder / "root/home/user/out/falling-ball/run.vtkhdf").exists())

    def test_pictures_and_images_by_software(self):
        """EGL and Mesa are dependencies of the package."""
        done = self.root.run("palpate", "run", "press-ball", "--picture", "--set", "contact.1.method=gpu")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("taken over", done.stderr)
        picture = self.folder / "root/home/user/out/press-ball/picture.png"
        self.assertGreater(picture.stat().st_size, 50_000)

    def test_models_are_made(self):
        done = self.root.run("palpate", "run", "gears", "--set", "scene.duration_s=0.01")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(list((self.folder / "root/home/user/.cache/palpate").rglob("gear.h5")))

    def test_a_report_needs_no_other_package(self):
        done = self.root.run("palpate", "run", "press-ball", "--report")
        self.assertEqual(done.returncode, 0, done.stderr)
        page = (self.folder / "root/home/user/out/press-ball/report.html").read_text()
        self.assertIn('class="plot-data"', page)

    def test_z_examples(self):
        """Runs last, as it installs a compiler."""
        self.root.install(f"/{self.library.name}", "cmake", "g++", "make")
        shutil.copytree(TREE / "examples", self.folder / "root/home/user/examples")
        source = "/home/user/examples"
        os.chown(self.folder / f"root{source}", USER, USER)
        programs = sorted(path.stem for path in (TREE / "examples").glob("*.cpp"))
        self.assertGreaterEqual(len(programs), 5)
        build = f"{source}/build"
        for words in (["cmake", "-S", source, "-B", build], ["cmake", "--build", build],
                      *([f"{build}/{program}"] for program in programs)):
            done = self.root.run(*words)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            if len(words) == 1:
                self.assertRegex(done.stdout, r"^ok")

    def test_zz_removal_leaves_nothing(self):
        must(*self.root.command(["apt-get", "remove", "--purge", "--yes", "palpate"]))
        root = self.folder / "root"
        left = [path for folder in ("usr/bin", "usr/lib", "usr/share", "usr/include")
                for path in (root / folder).rglob("*palpate*")]
        self.assertEqual(left, [])


if __name__ == "__main__":
    reason = missing()
    if reason:
        print(f"SKIPPED: {reason}")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
