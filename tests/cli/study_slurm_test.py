#!/usr/bin/env python3
"""`palpate study --slurm` on a real cluster of one node, which the test starts and stops: the same table as
on the cores of this machine, and a lost task or node affects no other task.

    study_slurm_test.py PROGRAM        skips (status 77) without root or the Debian package slurm-wlm
"""
import os
import re
import shutil
import signal
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import slurm_cluster  # noqa: E402
from study_scenes import LONG_TASKS, QUICK_TASKS, Studies  # noqa: E402

Studies.program = Path(sys.argv[1]).resolve()
MOST_ELEMENTS = 6  # MaxArraySize of the cluster: fewer than the quick study has tasks


class Slurm(Studies):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.mkdtemp(prefix="palpate-slurm-")
        cls.addClassCleanup(shutil.rmtree, folder, ignore_errors=True)
        cls.cluster = slurm_cluster.Cluster(folder, MaxArraySize=MOST_ELEMENTS, SlurmdTimeout=10)
        cls.addClassCleanup(cls.cluster.stop)
        cls.cluster.start()
        cls.environment = {name: cls.cluster.env[name] for name in ("SLURM_CONF", "PATH")}

    def until(self, condition, seconds=200):
        end = time.monotonic() + seconds
        while not (value := condition()):
            self.assertLess(time.monotonic(), end, self.cluster.logs())
            time.sleep(0.05)
        return value

    def running(self):
        """Returns the running elements of the array: "7_2"."""
        return self.cluster.said("squeue", "-h", "-t", "R", "-o", "%F_%K").split()

    def tasks_that_run(self):
        """Returns task -> process of the program on the node."""
        out = {}
        for pid in self.cluster.started_by_the_node():
            try:
                words = Path(f"/proc/{pid}/cmdline").read_bytes().decode().split("\0")
            except OSError:
                continue
            if "--task" in words and os.getppid() != pid:
                out.setdefault(words[words.index("--task") + 1], []).append(pid)
        return out

    def local(self, study):
        """Returns the table made on the cores of this machine."""
        self.good(study, "-o", "local")
        return self.table("local")

    def test_the_table_is_that_of_a_local_run(self):
        text = self.good("quick.toml", "-o", "cluster", "--slurm")
        self.assertRegex(text, rf"submitted as job \d+: {QUICK_TASKS} tasks in an array of {MOST_ELEMENTS}\n")
        self.assertIn(f"{QUICK_TASKS} tasks: {QUICK_TASKS} ok", text)
        script = (self.folder / "cluster/study.sbatch").read_text()
        self.assertIn(f"--array=0-{MOST_ELEMENTS - 1}\n", script)
        self.assertEqual(self.table("cluster"), self.local("quick.toml"))
        logs = sorted(path.read_text() for path in (self.folder / "cluster/slurm").glob("*.log"))
        self.assertEqual(len(logs), MOST_ELEMENTS)
        self.assertEqual(sum(int(log.split()[0]) for log in logs), QUICK_TASKS)
        self.assertNotIn("submitted", self.good("quick.toml", "-o", "cluster", "--slurm"), "all is there")

    def test_one_task_an_element_where_the_site_allows_it(self):
        options = "--time=10 --comment='a b'"
        text = self.good("long.toml", "-o", "cluster", "--slurm", "--slurm-options", options)
        self.assertIn(f"{LONG_TASKS} tasks in an array of {LONG_TASKS}", text)
        text = self.good("quick.toml", "-o", "chunks", "--slurm", "--chunk", "8")
        self.assertIn(f"{QUICK_TASKS} tasks in an array of 2", text)

    def test_a_cancelled_element_costs_its_task_alone(self):
        child = self.begin("long.toml", "-o", "cluster", "--slurm")
        element = self.until(self.running)[0]
        self.cluster.said("scancel", element)
        _, err = child.communicate(timeout=400)
        self.assertEqual(child.returncode, 3, err)
        task = element.split("_")[1]
        self.assertIn(f"missing result of task {task} (job ", err)
        status = [row["status"] for row in self.rows("cluster")]
        self.assertEqual(status.count("missing"), 1)
        self.assertEqual(status[int(task)], "missing")
        text = self.good("long.toml", "-o", "cluster", "--slurm")
        self.assertIn("1 tasks in an array of 1", text)
        self.assertEqual(self.table("cluster"), self.local("long.toml"))

    def test_a_killed_process_costs_its_task_alone(self):
        child = self.begin("long.toml", "-o", "cluster", "--slurm")
        self.until(lambda: len(self.tasks_that_run()) == 2)
        task, pids = sorted(self.tasks_that_run().items())[0]
        for pid in pids:
            os.kill(pid, signal.SIGKILL)
        _, err = child.communicate(timeout=400)
        self.assertEqual(child.returncode, 3, err)
        self.assertIn(f"missing result of task {task} (job ", err)
        self.good("long.toml", "-o", "cluster")  # the remaining tasks on this machine: results are shared
        self.assertEqual(self.table("cluster"), self.local("long.toml"))

    def test_a_lost_node_costs_what_it_was_running(self):
        child = self.begin("long.toml", "-o", "cluster", "--slurm")
        self.until(lambda: self.results("cluster") and len(self.running()) == 2)
        self.cluster.kill_node()
        before = self.stored("cluster")
        self.until(lambda: "down" in self.cluster.said("sinfo", "-h", "-o", "%T"))
        self.cluster.start_node()  # Slurm requeues the node's jobs, two minutes from now
        while child.poll() is None:
            for job in self.cluster.said("squeue", "-h", "-t", "PD", "-o", "%A").split():
                self.cluster.said("scontrol", "update", f"JobId={job}", "StartTime=now")
            time.sleep(1)
        out, err = child.communicate()
        self.assertEqual(child.returncode, 0, out + err)
        self.assertEqual(self.table("cluster"), self.local("long.toml"))
        after = self.stored("cluster")
        for key, result in before.items():
            self.assertEqual(after[key], result)

    def test_what_sbatch_says_is_shown_whole(self):
        text = self.refused("long.toml", "-o", "cluster", "--slurm", "--slurm-options", "--partition=nowhere")
        self.assertRegex(text, r"sbatch rejected cluster/study\.sbatch \(exit status 1\):\n"
                               r"sbatch: error: invalid partition specified: nowhere\nsbatch: error: ")

    def test_a_job_that_is_not_waited_for_is_found_again(self):
        text = self.good("long.toml", "-o", "cluster", "--slurm", "--no-wait")
        job = re.search(r"submitted as job (\d+)", text).group(1)
        self.assertIn(f"squeue -j {job}", text)
        self.assertFalse((self.folder / "cluster/study.csv").exists())
        (self.folder / "block.toml").write_text((self.folder / "block.toml").read_text() + "# changed\n")
        self.assertIn(f"scancel {job}", self.refused("long.toml", "-o", "cluster", "--slurm"))
        (self.folder / "block.toml").write_text(
            (self.folder / "block.toml").read_text().replace("# changed\n", ""))
        text = self.good("long.toml", "-o", "cluster", "--slurm")
        self.assertIn(f"job {job} of this study is still queued or running", text)
        self.assertNotIn("submitted", text)
        self.assertIn(f"{LONG_TASKS} ok", text)

    def test_ctrl_c_leaves_the_job_alone(self):
        child = self.begin("long.toml", "-o", "cluster", "--slurm")
        self.until(self.running)
        child.send_signal(signal.SIGINT)
        _, err = child.communicate(timeout=60)
        self.assertEqual(child.returncode, 130)
        self.assertRegex(err, r"job \d+ continues without this command")
        self.until(lambda: not self.cluster.said("squeue", "-h"))
        self.assertEqual(len(self.results("cluster")), LONG_TASKS)
        self.assertIn(f"{LONG_TASKS} ok", self.good("long.toml", "-o", "cluster", "--merge"))

    def test_a_study_that_changed_in_the_queue_is_not_run(self):
        self.cluster.said("scontrol", "update", "PartitionName=main", "State=DOWN")
        try:
            self.good("long.toml", "-o", "cluster", "--slurm", "--no-wait")
            self.put("long.toml", (self.folder / "long.toml").read_text().replace("4e4", "5e4"))
        finally:
            self.cluster.said("scontrol", "update", "PartitionName=main", "State=UP")
        self.until(lambda: not self.cluster.said("squeue", "-h"))
        self.assertEqual(self.results("cluster"), [])
        logs = [path.read_text() for path in (self.folder / "cluster/slurm").glob("*.log")]
        self.assertEqual(len(logs), LONG_TASKS)
        for log in logs:
            self.assertIn("submit it again", log)


if __name__ == "__main__":
    if reason := slurm_cluster.why_not():
        print("SKIPPED: no Slurm cluster can be started:", reason)
        sys.exit(77)
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
