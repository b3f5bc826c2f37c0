"""Settings that OpenBLAS and OpenMP read while they are loaded: those that the program gives itself.

src/cli/tune.cpp says why: kernels by the CPU's features, as OpenBLAS does not know the newest models, and one
thread, as more do not help matrices of this size.  With the same settings come the same bits.
"""
import os
from collections.abc import Iterator
from contextlib import contextmanager


def core_type(flags: set[str]) -> str:
    """OpenBLAS's name for the kernels of a CPU with these features; empty: its own choice stands."""
    if {"avx512f", "avx512dq", "avx512bw", "avx512vl", "avx512cd"} <= flags:
        return "SKYLAKEX"
    return "HASWELL" if {"avx2", "fma"} <= flags else ""


def cpu_flags() -> set[str]:
    """Of the first processor."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next((set(line.split(":")[1].split()) for line in file if line.startswith("flags")), set())
    except OSError:
        return set()


@contextmanager
def settings_of_the_program() -> Iterator[None]:
    """In the environment while libraries are loaded inside, and not afterwards.  What a person set stands."""
    wanted = {"OPENBLAS_CORETYPE": core_type(cpu_flags()), "OPENBLAS_NUM_THREADS": "1",
              "OMP_THREAD_LIMIT": "1"}
    provided = [name for name, text in wanted.items() if text and name not in os.environ]
    os.environ.update({name: wanted[name] for name in provided})
    try:
        yield
    finally:
        for name in provided:
            os.environ.pop(name, None)
