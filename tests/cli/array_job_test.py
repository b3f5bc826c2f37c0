#!/usr/bin/env python3
"""`--slurm` of study, compare, validate and stability, with programs that act as Slurm's and run the elements
of an array one after another: the same results as without it. study_slurm_test.py runs a real cluster.

    array_job_test.py PROGRAM
"""
import csv
import os
import re
import signal
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from program import PROGRAM, QUICK_COMPARISON, Cli  # noqa: E402
from study_scenes import BLOCK, QUICK, QUICK_TASKS  # noqa: E402

SBATCH = r"""#!/usr/bin/env python3
import os, pathlib, re, subprocess, sys
script = sys.argv[-1]
text = open(script).read()
number = len(list(pathlib.Path("jobs").glob("*"))) + 1
pathlib.Path(f"jobs/{number}").write_text(text)
for k in range(int(re.search(r"--array=0-(\d+)", text).group(1)) + 1):
    if os.environ.get("LOSE") != f"{number}_{k}":
        with open(f"jobs-{number}.log", "a") as log:
            subprocess.run(["bash", script], env={**os.environ, "SLURM_ARRAY_TASK_ID": str(k)}, stdout=log,
                           stderr=log)
print(number)
"""
# Results of a run that a clock determines.
TIMES = re.compile(r"_s($|_)|^cpu|^repeats$")


def children(process):
    try:
        return [int(one) for one in Path(f"/proc/{process}/task/{process}/children").read_text().split()]
    except OSError:  # it has ended
        return []


class ArrayJobs(Cli):
    def setUp(self):
        super().setUp()
        (self.folder / "jobs").mkdir()
        (self.folder / "slurm").mkdir()
        for name, text in (("sbatch", SBATCH), ("squeue", "#!/bin/sh\nexit 0\n"),
                           ("scontrol", "#!/bin/sh\necho 'MaxArraySize = 1001'\n")):
            (self.folder / "slurm" / name).write_text(text)
            (self.folder / "slurm" / name).chmod(0o755)

    def by_slurm(self, *arguments, status=0, **environment):
        done = self.call(*arguments, "--slurm", PATH=f"{self.folder}/slurm:{os.environ['PATH']}",
                         **environment)
        logs = "".join(path.read_text() for path in self.folder.glob("jobs-*.log"))
        self.assertEqual(done.returncode, status, done.stdout + done.stderr + logs)
        return done

    def jobs(self):
        """Returns the number of elements of each job."""
        scripts = sorted((self.folder / "jobs").iterdir(), key=lambda path: int(path.name))
        return [int(re.search(r"--array=0-(\d+)", path.read_text()).group(1)) + 1 for path in scripts]

    def rows(self, path):
        """Returns the rows of a table without times."""
        with open(self.folder / path, newline="", encoding="utf-8") as file:
            return [{name: cell for name, cell in row.items() if not TIMES.search(name)}
                    for row in csv.DictReader(file)]

    def test_study(self):
        (self.folder / "block.toml").write_text(BLOCK)
        (self.folder / "quick.toml").write_text(QUICK)
        self.good("study", "quick.toml", "-o", "local")
        done = self.by_slurm("study", "quick.toml", "-o", "cluster", "--chunk", "3", status=3, LOSE="1_1")
        self.assertIn(f"submitted as job 1: {QUICK_TASKS} tasks in an array of 6", done.stdout)
        self.assertIn("missing result of tasks 3-5 (job 1 ended without them", done.stderr)
        self.by_slurm("study", "quick.toml", "-o", "cluster")
        self.assertEqual(self.jobs(), [6, 3])
        self.assertEqual(*((self.folder / name / "study.csv").read_bytes() for name in ("local", "cluster")))
        self.assertFalse((self.folder / "cluster/tasks").exists(), "results are in results.db")

    def test_results_end_a_job_that_squeue_does_not_show(self):
        (self.folder / "slurm/squeue").write_text(
            "#!/bin/sh\necho Unable to contact slurm controller >&2\nexit 1\n")
        (self.folder / "block.toml").write_text(BLOCK)
        (self.folder / "quick.toml").write_text(QUICK)
        self.by_slurm("study", "quick.toml", "-o", "cluster")
        self.assertTrue(self.rows("cluster/study.csv"))

    def test_comparison_runs_references_before_sequences(self):
        arguments = ["compare", "cantilever", *QUICK_COMPARISON[2:], "--limit-s", "2", "--integrator",
                     "cvode-bdf", "--integrator", "linearly-implicit-euler"]
        self.good(*arguments, "-o", "local", "--jobs", "2")
        done = self.by_slurm(*arguments, "-o", "cluster")
        self.assertEqual(self.jobs()[0], 2, "a reference and its check")
        self.assertEqual(len(self.jobs()), 2)
        self.assertEqual(self.jobs()[1], 2, "one element runs all levels of a sequence")
        local, cluster = ({(row["label"], row["setting"]): row for row in self.rows(f"{folder}/compare.csv")
                           if row["status"] == "ok"} for folder in ("local", "cluster"))
        both = local.keys() & cluster.keys()  # the last level may run out of time in one of them
        self.assertGreater(len(both), 10)
        for point in both:
            self.assertEqual(local[point], cluster[point])
        self.assertIn("fitted order", done.stdout)
        again = self.by_slurm(*arguments, "-o", "cluster")
        self.assertIn("results are from earlier runs", again.stdout)
        self.assertEqual(len(self.jobs()), 2)
        self.assertIn("results are from earlier runs", self.good(*arguments, "-o", "cluster"))

    def test_haptic_comparison(self):
        arguments = ["compare", "--haptic", "press-ball", "--duration-s", "0.06", "--repeats", "1"]
        for one in ("exchange_periods_s=[0.02, 0.01]", "ticks_s=[0.002, 0.001]", "integrators=[]",
                    "reference_rtol=1e-4", "reference_refresh_s=4e-3"):
            arguments += ["--set", "compare.haptic." + one]
        self.good(*arguments, "-o", "local", "--jobs", "2")
        self.by_slurm(*arguments, "-o", "cluster")
        rows = self.rows("local/haptic.csv")
        self.assertEqual(self.rows("cluster/haptic.csv"), rows)
        self.assertEqual(self.jobs()[0], 2, "a reference and its check")
        self.assertEqual(len(self.jobs()), 2)

    def test_a_comparison_without_its_reference_says_so(self):
        arguments = ["compare", "cantilever", *QUICK_COMPARISON, "--integrator", "linearly-implicit-euler"]
        done = self.by_slurm(*arguments, "-o", "cluster", status=3, LOSE="1_0")
        self.assertRegex(done.stderr, r"missing result of task 0 \(job 1 ended without them")
        self.by_slurm(*arguments, "-o", "cluster")
        self.assertEqual(self.jobs(), [2, 1, 1], "the reference, then the sequence")

    def test_a_comparison_reports_a_task_that_was_killed(self):
        arguments = ["compare", "cantilever", *QUICK_COMPARISON, "--integrator", "linearly-implicit-euler",
                     "-o", "local"]
        command = subprocess.Popen([str(PROGRAM), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True, cwd=self.folder)
        killed = False
        while command.poll() is None and not killed:  # the first task, as the kernel does without memory
            servers = [server for helper in children(command.pid) for server in children(helper)]
            for task in [task for server in servers for task in children(server)][:1]:
                os.kill(task, signal.SIGKILL)
                killed = True
        _, errors = command.communicate(timeout=300)
        self.assertTrue(killed)
        self.assertEqual(command.returncode, 3, errors)
        self.assertRegex(errors, r"result of task \d+ \(killed by signal 9 .*; the same command runs it")
        self.good(*arguments)

    def test_trials_of_solvers_come_first(self):
        self.by_slurm("compare", "cantilever", *QUICK_COMPARISON, "--integrator", "linearly-implicit-euler",
                      "--linear-solver", "best", "-o", "cluster")
        self.assertGreaterEqual(len(self.jobs()), 3, "references, trials, sequences")
        self.assertTrue(self.rows("cluster/trials.csv"))
        self.assertTrue(self.rows("cluster/compare.csv"))

    def test_a_lost_trial_leaves_earlier_tables(self):
        arguments = ["compare", "cantilever", *QUICK_COMPARISON, "--integrator", "linearly-implicit-euler",
                     "-o", "cluster"]
        self.by_slurm(*arguments)
        table = (self.folder / "cluster/compare.csv").read_text()
        next_job = len(self.jobs()) + 1
        done = self.by_slurm(*arguments, "--linear-solver", "best", status=3, LOSE=f"{next_job}_0")
        self.assertRegex(done.stderr, r"missing result of task.* ended without them")
        self.assertEqual((self.folder / "cluster/compare.csv").read_text(), table)

    def test_matrix(self):
        arguments = ["stability", "--row", "youngs-modulus", "--integrator", "backward-euler", "--seeds", "1"]
        self.good(*arguments, "-o", "local", "--jobs", "2")
        done = self.by_slurm(*arguments, "-o", "cluster", "--chunk", "2")
        self.assertIn("cells agree with theory", done.stdout)
        rows = self.rows("local/stability.csv")
        self.assertEqual(self.rows("cluster/stability.csv"), rows)
        self.assertEqual(self.jobs(), [(len(rows) + 1) // 2])
        self.assertIn(f"{len(rows)} results are from earlier runs", self.good(*arguments, "-o", "cluster"))
        self.assertNotIn("earlier runs", self.good(*arguments, "-o", "cluster", "--fresh"))

    def test_validation(self):
        cases = ["patch-test", "rigid-motion"]
        local = self.good("validate", *cases).splitlines()
        done = self.by_slurm("validate", *cases, "-o", "cluster")
        for line in local:
            self.assertIn(line, done.stdout.splitlines())
        self.assertEqual(self.jobs(), [2])
        self.assertTrue((self.folder / "cluster/validation.json").exists())
        self.assertIn("2 results are from earlier runs", self.good("validate", *cases, "-o", "cluster"))

    def test_another_list_is_not_run(self):
        for command in (["compare", "one-tet", "--integrator", "backward-euler"], ["validate", "patch-test"],
                        ["stability", "--row", "step"]):
            text = self.refused(*command, "-o", "out", "--task", "0", "--plan", "0" * 32)
            self.assertIn("has changed since the job was submitted; submit it again", text)
            self.assertIn("tasks 0 to", self.refused(*command, "-o", "out", "--task", "9999"))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
