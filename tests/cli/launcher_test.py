#!/usr/bin/env python3
"""The launcher ./palpate, with dpkg, apt, cmake, ninja and ctest replaced by small fakes that record how they
were called."""
import os
import shutil
import stat
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]

FAKES = {
    # Reports every package as installed except those named in the file `missing`.
    "dpkg-query": r"""
printf "%s\n" "dpkg-query $*" >>"$CALLS"
shift 2
for p; do grep -qx "$p" "$FAKE/missing" || echo "$p installed"; done
""",
    "apt-get": r"""
echo "apt-get $*" >>"$CALLS"
case "$*" in
  *--simulate*) [ ! -e "$FAKE/no-lists" ] ;;
  *update*) rm -f "$FAKE/no-lists" ;;
  *"install --yes"*) [ -e "$FAKE/apt-fails" ] && { echo "E: broken" >&2; exit 100; }; : >"$FAKE/missing" ;;
esac
""",
    "sudo": r"""
echo "sudo $*" >>"$CALLS"
while [ "$1" = -n ]; do shift; done
exec "$@"
""",
    "cmake": r"""
echo "cmake $*" >>"$CALLS"
mkdir -p build/release/bin
touch build/release/build.ninja
""",
    "ninja": r"""
echo "ninja $*" >>"$CALLS"
[ ! -e "$FAKE/build-fails" ] || { echo "[1/2] Building"; echo "a.cpp:1: error: no"; exit 1; }
echo "[1/1 1s] Linking"
printf '#!/bin/sh\nfor a; do echo "[$a]"; done\nexit 7\n' >"$2/bin/palpate"
chmod +x "$2/bin/palpate"
[ ! -e "$FAKE/wheel" ] || { mkdir -p "$2/wheel"; touch "$2/wheel/palpate-1.whl"; }
""",
    "cpack": r"""
echo "cpack $* in $PWD" >>"$CALLS"
[ ! -e "$FAKE/cpack-fails" ] || { echo "CPack Error: no"; exit 1; }
mkdir -p packages/_CPack_Packages
touch packages/palpate_1.deb packages/libpalpate-dev_1.deb
""",
    # Copies the file `results`, if there is one, to the given path; exits with `ctest-status`.
    "ctest": r"""
echo "ctest $*" >>"$CALLS"
echo "what ctest prints"
while [ $# -gt 0 ]; do
  if [ "$1" = --output-junit ] && [ -e "$FAKE/results" ]; then cat "$FAKE/results" >"$2"; fi
  shift
done
[ ! -e "$FAKE/ctest-status" ] || exit "$(cat "$FAKE/ctest-status")"
""",
}

# The format of ctest 3.25, with one test each: passed, failed, skipped by the test, without its program,
# timed out, disabled.
RESULTS = """<?xml version="1.0" encoding="UTF-8"?>
<testsuite name="(empty)"
\ttests="6"
\tfailures="2"
\tdisabled="1"
\tskipped="2"
\t>
\t<testcase name="good" classname="good" time="0.008" status="run">
\t\t<system-out>&lt;testcase status="run"&gt;
</system-out>
\t</testcase>
\t<testcase name="bad" classname="bad" time="0.05" status="fail">
\t\t<failure message=""/>
\t\t<system-out></system-out>
\t</testcase>
\t<testcase name="skip" classname="skip" time="0.001" status="notrun">
\t\t<skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/>
\t\t<system-out>[  SKIPPED ]
</system-out>
\t</testcase>
\t<testcase name="missing" classname="missing" time="0" status="notrun">
\t\t<skipped message="Unable to find executable"/>
\t\t<system-out>Unable to find executable: /nowhere/at/all</system-out>
\t</testcase>
\t<testcase name="late" classname="late" time="1.01" status="fail">
\t\t<failure message=""/>
\t\t<system-out></system-out>
\t</testcase>
\t<testcase name="off" classname="off" time="0" status="disabled">
\t\t<system-out>Disabled</system-out>
\t</testcase>
</testsuite>
"""


class Launcher(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        self.tree = self.folder / "a tree"  # with a blank, as in users' paths
        self.tree.mkdir()
        for name in ("palpate", ".packages", "CMakePresets.json"):
            shutil.copy(TREE / name, self.tree)
        self.fake = self.folder / "fake"
        self.fake.mkdir()
        (self.fake / "missing").write_text("")
        for name, script in FAKES.items():
            self.write_fake(name, script)
        self.calls_file = self.folder / "calls"

    def write_fake(self, name, script):
        path = self.fake / name
        path.write_text("#!/bin/sh\n" + script + "\n")
        path.chmod(path.stat().st_mode | stat.S_IXUSR)

    def launch(self, *arguments, path=None, as_root=True):
        self.calls_file.write_text("")
        environment = dict(os.environ, PATH=path or f"{self.fake}:/usr/bin:/bin", CALLS=str(self.calls_file),
                           FAKE=str(self.fake))
        nobody = {} if as_root or os.geteuid() != 0 else {"user": 65534}
        if nobody:
            subprocess.run(["chmod", "-R", "a+rwX", str(self.folder)], check=True)
        done = subprocess.run([str(self.tree / "palpate"), *arguments], capture_output=True, text=True,
                              env=environment, stdin=subprocess.DEVNULL, cwd=self.folder, timeout=60,
                              **nobody)
        self.calls = self.calls_file.read_text().splitlines()
        return done

    def called(self, program):
        return [call for call in self.calls if call.split()[0] == program]

    def test_builds_then_runs_with_the_same_arguments_and_status(self):
        done = self.launch("run", "a b", "--set", "x=1")
        self.assertEqual((done.returncode, done.stdout), (7, "[run]\n[a b]\n[--set]\n[x=1]\n"), done.stderr)
        self.assertEqual(self.called("cmake"), ["cmake --preset release"])
        self.assertTrue(self.called("ninja")[0].endswith(" palpate"), self.calls)
        self.assertFalse(self.called("apt-get"))

    def test_second_call_asks_neither_dpkg_nor_cmake(self):
        self.launch("list")
        self.launch("list")
        self.assertEqual([call.split()[0] for call in self.calls], ["ninja"])

    def test_changed_list_is_checked_again(self):
        self.launch("list")
        with (self.tree / ".packages").open("a") as file:
            file.write("zzz-new\n")
        self.launch("list")
        self.assertEqual(len(self.called("dpkg-query")), 1)
        self.assertIn("zzz-new", self.called("dpkg-query")[0])

    def test_help_goes_to_the_program(self):
        self.assertEqual(self.launch("--help").stdout, "[--help]\n")

    def test_no_install_refuses_and_names_the_command(self):
        (self.fake / "missing").write_text("libccd-dev\nninja-build\n")
        done = self.launch("--no-install", "demo")
        self.assertEqual(done.returncode, 1)
        self.assertIn("apt-get install --yes --no-install-recommends ninja-build libccd-dev\n", done.stderr)
        self.assertIn("  libccd-dev\n", done.stderr)
        self.assertFalse(self.called("apt-get") + self.called("ninja") + self.called("sudo"))

    def test_installs_what_is_missing_and_fetches_lists_only_when_needed(self):
        (self.fake / "missing").write_text("libccd-dev\n")
        done = self.launch("list")
        self.assertEqual(done.returncode, 7, done.stderr)
        self.assertIn("libccd-dev", done.stderr)
        self.assertFalse([call for call in self.called("apt-get") if "update" in call])
        install = "install --yes --no-install-recommends libccd-dev"
        self.assertTrue(any(install in call for call in self.called("apt-get")), self.calls)

        (self.fake / "missing").write_text("libccd-dev\n")
        (self.fake / "no-lists").write_text("")
        (self.tree / "build/packages.stamp").unlink()
        self.launch("list")
        self.assertEqual(len([call for call in self.called("apt-get") if "update" in call]), 1, self.calls)

    def test_other_users_go_through_sudo_and_are_told(self):
        (self.fake / "missing").write_text("libccd-dev\n")
        done = self.launch("list", as_root=False)
        self.assertEqual(done.returncode, 7, done.stderr)
        self.assertIn("sudo apt-get install --yes --no-install-recommends libccd-dev\n", done.stderr)
        start = "sudo -n env DEBIAN_FRONTEND=noninteractive apt-get "
        self.assertTrue(all(call.startswith(start) for call in self.called("sudo")), self.calls)
        self.assertEqual(len(self.called("sudo")), len(self.called("apt-get")))

    def test_without_sudo_the_command_for_root_is_given(self):
        (self.fake / "missing").write_text("libccd-dev\n")
        (self.fake / "sudo").unlink()
        if shutil.which("sudo", path="/usr/bin:/bin"):
            self.skipTest("this system has sudo beside the fake one")
        done = self.launch("list", as_root=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("as root, run:\n  apt-get update && apt-get install --yes --no-install-recommends "
                      "libccd-dev\n", done.stderr)
        self.assertFalse(self.called("apt-get"))

    def test_failing_installation_shows_why(self):
        (self.fake / "missing").write_text("libccd-dev\n")
        (self.fake / "apt-fails").write_text("")
        done = self.launch("list")
        self.assertEqual(done.returncode, 1)
        self.assertIn("E: broken", done.stderr)
        self.assertIn("apt-get failed to install them", done.stderr)

    def test_other_system_is_told_what_is_needed(self):
        bare = self.folder / "bare"
        bare.mkdir()
        for name in ("bash", "env", "readlink", "cat", "mkdir", "cp", "nproc", "flock", "rm", "sh", "tail",
                     "grep", "touch", "chmod", "printf"):
            found = shutil.which(name, path="/usr/bin:/bin")
            if found:
                (bare / name).symlink_to(found)
        for name in ("cmake", "ninja"):
            (bare / name).symlink_to(self.fake / name)
        done = self.launch("list", path=str(bare))
        self.assertEqual(done.returncode, 1)
        self.assertIn("not a Debian system", done.stderr)
        self.assertIn("libsimbody-dev", done.stderr)
        done = self.launch("--assume-packages", "list", path=str(bare))
        self.assertEqual((done.returncode, done.stdout), (7, "[list]\n"), done.stderr)

    def test_failing_build_shows_the_error_and_the_log(self):
        (self.fake / "build-fails").write_text("")
        done = self.launch("list")
        self.assertEqual(done.returncode, 1)
        self.assertIn("a.cpp:1: error: no", done.stderr)
        self.assertIn("build/release/build.log", done.stderr)
        self.assertEqual(done.stdout, "")

    def test_package_builds_what_is_installed_and_names_the_packages(self):
        done = self.launch("package")
        packages = self.tree / "build/release/packages"
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(self.called("ninja")[0].endswith(" installable"), self.calls)
        self.assertEqual(self.called("cpack"), [f"cpack  in {self.tree}/build/release"])
        self.assertEqual(done.stdout, f"{packages}/libpalpate-dev_1.deb\n{packages}/palpate_1.deb\n")
        self.assertFalse((packages / "_CPack_Packages").exists())
        (packages / "palpate_0.deb").touch()
        self.assertNotIn("palpate_0", self.launch("package").stdout)  # of an earlier version

    def test_package_that_fails_shows_why(self):
        (self.fake / "cpack-fails").write_text("")
        done = self.launch("package")
        self.assertEqual(done.returncode, 1)
        self.assertIn("CPack Error: no", done.stderr)
        self.assertIn("cpack failed", done.stderr)

    def test_package_takes_no_argument(self):
        done = self.launch("package", "deb")
        self.assertEqual(done.returncode, 1)
        self.assertIn("package takes no argument", done.stderr)
        self.assertFalse(self.called("cpack"))

    def test_wheel_is_built_with_python_and_named(self):
        (self.fake / "wheel").write_text("")
        done = self.launch("wheel")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout, f"{self.tree}/build/release/wheel/palpate-1.whl\n")
        self.assertEqual(self.called("cmake"), ["cmake --preset release -DPALPATE_WITH_PYTHON=ON"])
        self.assertTrue(self.called("ninja")[0].endswith(" wheel palpate-model palpate"), self.calls)
        (self.tree / "build/release/CMakeCache.txt").write_text("PALPATE_WITH_PYTHON:BOOL=ON\n")
        self.launch("wheel")
        self.assertEqual(self.called("cmake"), [], "configured once")
        done = self.launch("wheel", "now")
        self.assertEqual(done.returncode, 1)
        self.assertIn("wheel takes no argument", done.stderr)

    def test_test_builds_all_and_leaves_slow_ones_out(self):
        self.launch("test", "-R", "fem")
        self.assertTrue(self.called("ninja")[0].endswith(" all"), self.calls)
        self.assertIn("-R fem -LE slow", self.called("ctest")[0])
        self.assertIn("--output-on-failure", self.called("ctest")[0])
        self.launch("test", "--slow")
        self.assertNotIn("slow", self.called("ctest")[0])

    def test_test_counts_in_its_last_line_and_keeps_the_status(self):
        (self.fake / "results").write_text(RESULTS)
        (self.fake / "ctest-status").write_text("8")
        done = self.launch("test")
        self.assertEqual(done.returncode, 8, done.stderr)
        self.assertEqual(done.stdout, "what ctest prints\n1 passed, 3 failed, 2 skipped\n")
        (self.fake / "results").write_text(RESULTS.replace('status="fail"', 'status="run"'))
        (self.fake / "ctest-status").unlink()
        done = self.launch("test", "-R", "fem")
        self.assertEqual(done.returncode, 0)
        self.assertEqual(done.stdout.splitlines()[-1], "3 passed, 1 failed, 2 skipped")

    def test_test_counts_what_its_user_wants_kept_and_nothing_where_nothing_ran(self):
        (self.fake / "results").write_text(RESULTS)
        done = self.launch("test", "--output-junit", "mine.xml")
        self.assertEqual(done.stdout.splitlines()[-1], "1 passed, 3 failed, 2 skipped")
        self.assertEqual((self.folder / "mine.xml").read_text(), RESULTS)
        self.assertEqual(self.launch("test", "-N").stdout, "what ctest prints\n")
        (self.fake / "results").unlink()
        self.assertEqual(self.launch("test").stdout, "what ctest prints\n", "no count of an earlier call")

    def test_help_of_test_and_build_builds_nothing(self):
        (self.fake / "missing").write_text("libccd-dev\n")  # installs nothing
        for command, word in {"test": "--slow", "build": "[target...]", "package": "libpalpate-dev",
                              "wheel": "pip install"}.items():
            for option in "--help", "-h":
                done = self.launch(command, "-R", "fem", option)
                self.assertEqual((done.returncode, done.stderr, self.calls), (0, "", []), command)
                self.assertIn(word, done.stdout)
                self.assertIn(f"./palpate {command} ", done.stdout)
                self.assertTrue(all(len(line) < 100 for line in done.stdout.splitlines()))
        self.assertIn("ctest options", self.launch("test", "--help").stdout)


if __name__ == "__main__":
    if shutil.which("bash") is None:
        sys.exit("bash is missing")
    unittest.main()
