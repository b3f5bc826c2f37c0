#!/usr/bin/env python3
"""Runs libFuzzer's program over each target, one after another, and prints a summary.

    run_fuzzers.py PROGRAM [--seconds N] [--work DIR] [--jobs N] [TARGET...]

PROGRAM is build/fuzz/tests/fuzz/palpate_fuzzer: `cmake --preset fuzz && ninja -C build/fuzz palpate_fuzzer`.
It starts with the inputs of corpus/TARGET and with earlier findings in DIR. Inputs that break a reader are
copied to DIR/TARGET/findings; once the reader is fixed, they belong in corpus/TARGET. The exit status is 1 if
a reader broke.
"""
import argparse
import concurrent.futures
import os
import re
import subprocess
import sys
from pathlib import Path

CORPORA = Path(__file__).resolve().parent / "corpus"
ENVIRONMENT = {"ASAN_OPTIONS": "detect_leaks=1:allocator_may_return_null=1",
               "UBSAN_OPTIONS": "print_stacktrace=1"}
# HDF5 leaks data that it could not read completely, and allocates as much memory as a damaged file requests;
# both end with the child process that reads first. A small process is copied faster.
OF_HDF5 = "detect_leaks=0:allocator_may_return_null=1:quarantine_size_mb=8"
ALLOCATES_AS_TOLD = {"mesh_file", "model_file", "run_file", "mesh_content", "model_content", "run_content",
                     "checkpoint_file", "checkpoint_content"}


def targets_of(program):
    """Returns the names of all targets, which the program lists if none is given."""
    done = subprocess.run([program], capture_output=True, text=True, check=False)
    return re.findall(r"^  (\w+) ", done.stderr, re.M)


def number(log, pattern):
    found = re.findall(pattern, log)
    return int(found[-1]) if found else 0


def fuzz(program, target, seconds, work):
    """Fuzzes one target: returns a line for the summary, and whether no reader broke."""
    folder, findings = work / target / "corpus", work / target / "findings"
    folder.mkdir(parents=True, exist_ok=True)
    findings.mkdir(exist_ok=True)
    command = [program, f"--target={target}", f"-max_total_time={seconds}", "-timeout=20",
               "-rss_limit_mb=2048", "-max_len=65536", "-print_final_stats=1",
               f"-artifact_prefix={findings}/"]
    environment = dict(os.environ, **ENVIRONMENT)
    if target in ALLOCATES_AS_TOLD:
        command += ["-malloc_limit_mb=1000000", "-detect_leaks=0"]
        environment["ASAN_OPTIONS"] = OF_HDF5
    else:
        command += ["-malloc_limit_mb=512"]
    done = subprocess.run([*command, str(folder), str(CORPORA / target)], env=environment, check=False,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, errors="replace", text=True)
    log = done.stdout
    (work / target / "log").write_text(log)
    inputs, rate = number(log, r"stat::number_of_executed_units: *(\d+)"), number(log, r"per_sec: *(\d+)")
    edges, features = number(log, r"cov: (\d+)"), number(log, r"ft: (\d+)")
    figures = f"{inputs} inputs, {rate} a second, {edges} edges, {features} features"
    if done.returncode == 0:
        return f"{target}: {figures}; nothing broke", True
    reason = re.findall(r"(?:SUMMARY|runtime error|what\(\)):? *(.*)", log)
    return f"{target}: {figures}; BROKE: {reason[0] if reason else 'see its log'} ({findings})", False


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("targets", nargs="*")
    parser.add_argument("--seconds", type=int, default=10)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--work", type=Path, default=None)
    arguments = parser.parse_intermixed_args()
    program = str(Path(arguments.program).resolve())
    work = (arguments.work or Path(program).parent / "work").resolve()
    all_good = True
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        started = [pool.submit(fuzz, program, target, arguments.seconds, work)
                   for target in arguments.targets or targets_of(program)]
        for one in concurrent.futures.as_completed(started):
            line, good = one.result()
            print(line, flush=True)
            all_good = all_good and good
    return 0 if all_good and started else 1


if __name__ == "__main__":
    sys.exit(main())
