"""A Slurm cluster of one node on loopback, in a separate folder: nothing of a cluster that the machine may
belong to is read or changed. Requires root and the Debian package slurm-wlm."""
import os
import shutil
import socket
import subprocess
import time
from pathlib import Path

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scancel", "scontrol")


def why_not():
    """Returns the reason why no cluster can be started here; empty if one can."""
    path = os.environ.get("PATH", "") + ":/usr/sbin"
    missing = [name for name in PROGRAMS if not shutil.which(name, path=path)]
    if missing:
        return f"{', '.join(missing)} missing: install the Debian package slurm-wlm"
    return "" if os.geteuid() == 0 else "slurmd runs the jobs of others: only root can start it"


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class Cluster:
    def __init__(self, folder, cpus=2, **settings):
        self.folder = Path(folder)
        self.folder.chmod(0o755)
        self.host = socket.gethostname().partition(".")[0]
        self.env = {**os.environ, "SLURM_CONF": str(self.folder / "slurm.conf"),
                    "PATH": os.environ.get("PATH", "") + ":/usr/sbin"}
        self.processes = {}
        for name in ("state", "spool", "log"):
            (self.folder / name).mkdir()
        (self.folder / "munge.key").write_bytes(os.urandom(128))
        (self.folder / "munge.key").chmod(0o600)
        given = {
            "ClusterName": "loopback", "SlurmctldHost": f"{self.host}(127.0.0.1)",
            "AuthType": "auth/munge", "AuthInfo": f"socket={self.folder}/munge.socket",
            "CredType": "cred/munge", "SlurmUser": "root", "SlurmdUser": "root",
            "StateSaveLocation": self.folder / "state", "SlurmdSpoolDir": self.folder / "spool",
            "SlurmctldPidFile": self.folder / "slurmctld.pid", "SlurmdPidFile": self.folder / "slurmd.pid",
            "SlurmctldPort": free_port(), "SlurmdPort": free_port(),
            "ProctrackType": "proctrack/linuxproc", "TaskPlugin": "task/none", "MpiDefault": "none",
            "AccountingStorageType": "accounting_storage/none", "JobAcctGatherType": "jobacct_gather/none",
            "SelectType": "select/cons_tres", "SelectTypeParameters": "CR_CPU", "ReturnToService": "2",
            "SchedulerParameters": "batch_sched_delay=0,sched_interval=1,bf_interval=1",
            "KillWait": "2", "NodeName": f"{self.host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN",
            "PartitionName": f"main Nodes={self.host} Default=YES MaxTime=INFINITE State=UP"}
        given.update(settings)
        text = "".join(f"{key}={value}\n" for key, value in given.items())
        (self.folder / "slurm.conf").write_text(text)

    def start(self):
        self.run("munged", "--foreground", "--force", f"--key-file={self.folder}/munge.key",
                 f"--socket={self.folder}/munge.socket", f"--pid-file={self.folder}/munged.pid",
                 f"--log-file={self.folder}/log/munged", f"--seed-file={self.folder}/munge.seed",
                 "--num-threads=2")
        self.until(lambda: (self.folder / "munge.socket").exists(), "munged")
        self.run("slurmctld", "-D", "-i")
        self.start_node()

    def start_node(self):
        self.run("slurmd", "-D")
        self.until(lambda: self.said("sinfo", "-h", "-o", "%T").strip() in ("idle", "mixed", "allocated"),
                   "the node")

    def run(self, name, *options):
        with open(self.folder / "log" / f"{name}.out", "ab") as log:
            self.processes[name] = subprocess.Popen([name, *options], env=self.env, stdout=log, stderr=log,
                                                    stdin=subprocess.DEVNULL, start_new_session=True)

    def until(self, condition, what, seconds=60):
        end = time.monotonic() + seconds
        while not condition():
            for name, process in self.processes.items():
                if process.poll() is not None:
                    raise RuntimeError(f"{name} has ended:\n{self.logs()}")
            if time.monotonic() > end:
                raise RuntimeError(f"{what} does not come up:\n{self.logs()}")
            time.sleep(0.1)

    def logs(self):
        return "\n".join(f"--- {file.name}\n{file.read_text(errors='replace')[-3000:]}"
                         for file in sorted((self.folder / "log").iterdir()))

    def said(self, *words):
        return subprocess.run(words, env=self.env, capture_output=True, text=True, timeout=60).stdout

    def kill_node(self):
        """Kills the node as in a power cut: its daemon and everything that it has started."""
        node = self.processes.pop("slurmd")
        node.kill()
        node.wait()
        for pid in self.started_by_the_node():
            try:
                os.kill(pid, 9)
            except ProcessLookupError:
                pass

    def started_by_the_node(self):
        """Job steps and their processes: their environment specifies this cluster's configuration."""
        mark = f"SLURM_CONF={self.env['SLURM_CONF']}".encode()
        out = []
        for folder in Path("/proc").iterdir():
            if not folder.name.isdigit():
                continue
            try:
                environment = (folder / "environ").read_bytes().split(b"\0")
                name = (folder / "comm").read_text().strip()
            except OSError:
                continue
            in_job = any(one.startswith(b"SLURM_JOB_ID=") for one in environment)
            if mark in environment and (in_job or name == "slurmstepd"):
                out.append(int(folder.name))
        return out

    def stop(self):
        self.said("scancel", "--full", "--user=root")
        for pid in self.started_by_the_node():
            try:
                os.kill(pid, 9)
            except ProcessLookupError:
                pass
        for name in ("slurmd", "slurmctld", "munged"):
            process = self.processes.pop(name, None)
            if process and process.poll() is None:
                process.terminate()
                try:
                    process.wait(15)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()
