#!/usr/bin/env python3
"""The user interface of `palpate study`: the list of tasks, the table, lost tasks and their repetition.

    study_test.py PROGRAM
"""
import os
import re
import signal
import sys
import time
import unittest
import xml.dom.minidom
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from study_scenes import LONG_TASKS, QUICK, QUICK_TASKS, Studies  # noqa: E402

Studies.program = Path(sys.argv[1]).resolve()


def children_of(pid):
    try:
        return [int(one) for one in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except OSError:
        return []


def descendants_of(pid):
    out = []
    for child in children_of(pid):
        out += [child, *descendants_of(child)]
    return out


class Tables(Studies):
    def test_dry_run_lists_the_tasks_and_makes_nothing(self):
        text = self.good("quick.toml", "--dry-run")
        self.assertIn(f"{QUICK_TASKS} tasks", text)
        rows = re.findall(r"^ *(\d+) +block\.toml +(\S+) +(.*?) +([0-9a-f]{32})$", text, re.M)
        self.assertEqual([int(row[0]) for row in rows], list(range(QUICK_TASKS)))
        self.assertEqual(len({row[3] for row in rows}), QUICK_TASKS)
        self.assertEqual(text, self.good(str(self.folder / "quick.toml"), "--dry-run"))
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()),
                         ["block.toml", "long.toml", "quick.toml"])

    def test_the_table_is_the_same_whichever_way_it_ran(self):
        self.good("quick.toml", "-o", "two", "--jobs", "2")
        whole = self.table("two")
        self.good("quick.toml", "-o", "one", "--jobs", "1")
        self.assertEqual(self.table("one"), whole)
        for tasks in ("9-15", "3", "0-2,4-8"):
            text = self.good("quick.toml", "-o", "parts", "--task", tasks)
            self.assertRegex(text, r"^\d+ run, 0 done before")
        self.assertFalse((self.folder / "parts/study.csv").exists())
        self.good("quick.toml", "-o", "parts", "--merge")
        self.assertEqual(self.table("parts"), whole)
        rows = self.rows("two")
        self.assertEqual(len(rows), QUICK_TASKS)
        self.assertEqual({row["status"] for row in rows}, {"ok"})
        self.assertEqual([row["seed"] for row in rows], ["1", "2"] * (QUICK_TASKS // 2))
        self.assertEqual(len({row["end_state"] for row in rows}), QUICK_TASKS)
        density = {(row["seed"], row["body.0.density_kg_m3"]) for row in rows}
        self.assertEqual(len(density), 2, "a seed is the same body for every integrator")
        for row in self.rows("two", "study-times.csv"):
            self.assertGreater(float(row["loop_cpu_s"]), 0.0)
            self.assertTrue(row["host"] and row["cpu"])

    def test_a_task_can_be_run_alone_by_the_command_of_its_result(self):
        self.good("quick.toml", "-o", "out", "--task", "5")
        (command, _), = self.stored("out").values()
        self.assertRegex(command, r"^palpate run '/.*block\.toml' --set 'integrator\.name=")
        words = re.findall(r"'([^']*)'", command)
        self.assertEqual(self.call("quick.toml", "-o", "out", "--merge").returncode, 3)
        row = self.rows("out")[5]
        self.assertEqual((row["seed"], row["status"]), ("2", "ok"))
        self.assertIn("body.0.density_kg_m3=" + row["body.0.density_kg_m3"], words)

    def test_report_has_charts_and_spreads(self):
        text = self.good("quick.toml", "-o", "out")
        self.assertIn(f"{QUICK_TASKS} tasks: {QUICK_TASKS} ok", text)
        page = (self.folder / "out/report.html").read_text()
        xml.dom.minidom.parseString(page)
        for words in ("<h1>Study: quick", f"All {QUICK_TASKS} tasks finished.",
                      "Spread over the seeds", "largest displacement [m]",
                      "Largest displacement [m] over body 0: Young",
                      "lines are means over the seeds", "[[random]]"):
            self.assertIn(words, page)
        self.assertGreaterEqual(page.count('class="plot-data"'), 3)

    def test_what_ends_badly_is_a_row(self):
        self.put("bad.toml", QUICK + '[[sweep]]\nkey = "body.0.poissons_ratio"\nvalues = [0.3, 0.7]\n')
        text = self.good("bad.toml", "-o", "out")
        self.assertIn(f"{2 * QUICK_TASKS} tasks: {QUICK_TASKS} ok, {QUICK_TASKS} refused", text)
        self.assertRegex(text, r"refused: task 2: .*poissons_ratio = 0\.7 must lie in")
        bad = [row for row in self.rows("out") if row["body.0.poissons_ratio"] == "0.7"]
        self.assertEqual({row["status"] for row in bad}, {"refused"})
        self.assertEqual(self.table("out"), (self.good("bad.toml", "-o", "o2", "--jobs", "1"),
                                             self.table("o2"))[1])

    def test_a_changed_scene_is_another_study(self):
        self.good("quick.toml", "-o", "out")
        self.put("block.toml", (self.folder / "block.toml").read_text().replace("-9.81", "-9.82"))
        done = self.call("quick.toml", "-o", "out", "--merge")
        self.assertEqual(done.returncode, 3)
        self.assertIn(f"missing result of tasks 0-{QUICK_TASKS - 1}", done.stderr)
        self.assertEqual({row["status"] for row in self.rows("out")}, {"missing"})
        self.assertNotIn("done before", self.good("quick.toml", "-o", "out"))
        self.assertIn(f"{QUICK_TASKS} results are from earlier runs", self.good("quick.toml", "-o", "out"))
        self.assertNotIn("done before", self.good("quick.toml", "-o", "out", "--fresh"))


class Refusals(Studies):
    def test_typing_errors_name_the_nearest_key_and_the_place(self):
        self.put("typo.toml", QUICK.replace("rtol =", "rtoll ="))
        self.assertRegex(self.refused("typo.toml"), r'typo\.toml:4:1: study: unknown key "rtoll" '
                                                    r'\(did you mean "rtol"\?\)')
        self.put("typo.toml", QUICK.replace("youngs_modulus_pa", "youngs_module_pa"))
        self.assertRegex(self.refused("typo.toml"), r'did you mean "youngs_modulus_pa"\?')
        self.put("typo.toml", QUICK.replace("block.toml", "press-bal"))
        self.assertIn('did you mean "press-ball"?', self.refused("typo.toml"))
        self.assertIn("no such study file", self.refused("gone.toml"))

    def test_options_that_do_not_go_together(self):
        for options in (("--task", "0", "--merge"), ("--fresh", "--merge"), ("--task", "0", "--slurm"),
                        ("--chunk", "2"), ("--no-wait",), ("--slurm", "--dry-run"), ("--jobs", "0")):
            self.refused("quick.toml", *options)
        self.assertIn("tasks 0 to 15, and no 16", self.refused("quick.toml", "--task", "16"))

    def test_another_plan_is_not_run(self):
        self.assertIn("submit it again", self.refused("quick.toml", "--task", "0", "--plan", "0" * 32))

    def test_without_slurm_the_package_is_named(self):
        empty = {**self.environment, "PATH": str(self.folder)}
        Refusals.environment = empty
        self.addCleanup(setattr, Refusals, "environment", {})
        text = self.refused("quick.toml", "--slurm", "-o", "out")
        self.assertRegex(text, r"was not found: it belongs to Slurm; install the package slurm-client")


class Losses(Studies):
    def wait_for(self, condition):
        end = time.monotonic() + 200
        while not condition():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)

    def workers(self, study):
        """Processes of tasks: those without children, below the helper and its server."""
        return [pid for pid in descendants_of(study.pid) if not children_of(pid)
                and Path(f"/proc/{pid}/stat").read_text().split()[2] == "R"]

    def test_a_killed_study_goes_on_where_it_was(self):
        self.good("quick.toml", "-o", "whole")
        for least in (3, 9):
            child = self.begin("quick.toml", "-o", "killed", "--jobs", "2")
            self.wait_for(lambda: child.poll() is not None or len(self.results("killed")) >= least)
            child.kill()
            child.wait()
        kept = len(self.results("killed"))
        self.assertGreaterEqual(kept, 9)
        text = self.good("quick.toml", "-o", "killed")
        self.assertIn(f"{kept} results are from earlier runs", text)
        self.assertEqual(self.table("killed"), self.table("whole"))

    def kill_a_worker(self, sig, folder):
        child = self.begin("long.toml", "-o", folder, "--jobs", "2")
        self.wait_for(lambda: len(self.workers(child)) == 2)
        time.sleep(0.2)
        os.kill(self.workers(child)[0], sig)
        out, err = child.communicate(timeout=400)
        return child.returncode, out, err

    def test_a_crash_is_a_result_and_leaves_the_others(self):
        status, out, err = self.kill_a_worker(signal.SIGSEGV, "out")
        self.assertEqual(status, 0, err)
        self.assertIn(f"{LONG_TASKS - 1} ok, 1 crashed", out)
        self.assertIn("killed by signal 11", out)
        self.assertEqual(sorted(row["status"] for row in self.rows("out")), ["crashed"] + ["ok"] * 3)

    def test_a_task_that_is_killed_from_outside_is_missing_and_run_again(self):
        status, _, err = self.kill_a_worker(signal.SIGKILL, "out")
        self.assertEqual(status, 3)
        self.assertRegex(err, r"missing result of task \d \(task \d: killed by signal 9 .*run")
        self.assertEqual(sorted(row["status"] for row in self.rows("out")), ["missing"] + ["ok"] * 3)
        before = self.rows("out")
        self.assertIn("3 results are from earlier runs", self.good("long.toml", "-o", "out"))
        after = self.rows("out")
        self.assertEqual({row["status"] for row in after}, {"ok"})
        for old, new in zip(before, after):
            if old["status"] == "ok":
                self.assertEqual(old, new)

    def test_ctrl_c_ends_it_and_says_how_to_go_on(self):
        child = self.begin("long.toml", "-o", "out", "--jobs", "2")
        self.wait_for(lambda: len(self.workers(child)) == 2)
        child.send_signal(signal.SIGINT)
        _, err = child.communicate(timeout=60)
        self.assertEqual(child.returncode, 130)
        self.assertIn("the same command resumes", err)
        self.assertEqual(self.results("out"), [])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
