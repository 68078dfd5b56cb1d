#!/usr/bin/python3
"""scaling.py [BUILD]: wall-clock time of starts, profiles, loops and grids on one and on two
threads, the least of three runs in turns, and what the second thread is worth."""
import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "build" / "release"
JOBS = ROOT / "configs" / "jobs"
FIT, GRID = BUILD / "apps" / "fit-params", BUILD / "bench" / "confusion"
WORK = {
    "24 starts": [FIT, JOBS / "paper.yaml", "--starts", "24"],
    "starts and profiles": [FIT, JOBS / "paper.yaml", "--starts", "24", "--profile"],
    "a fit and its loop": [FIT, JOBS / "close-loop.yaml", "--close-loop"],
    "grid of loops": [GRID, ROOT / "configs" / "axes" / "x.yaml", "--effects", "added_mass",
                      "--targets", "3", "--repeats", "4", "--clean", "0", "--pairs", "0"],
}


def seconds(command):
    """On one thread and on two."""

    def once(threads):
        begin = time.perf_counter()
        subprocess.run([*command, "--threads", str(threads)], stdout=subprocess.DEVNULL, check=True)
        return time.perf_counter() - begin

    turns = [(once(1), once(2)) for _ in range(3)]
    return map(min, zip(*turns))


def row(name, one, two):
    print(f"{name:<24} {one:>7.2f} s {two:>8.2f} s {100.0 * one / (2.0 * two):>9.0f} %", flush=True)


print(f"{'':<24} {'1 thread':>9} {'2 threads':>10} {'efficiency':>11}")
for name, command in WORK.items():
    one, two = seconds(command)
    row(name, one, two)
    if "--close-loop" in command:
        fit_one, fit_two = seconds(command[:-1])
        row("the loop alone", one - fit_one, two - fit_two)
