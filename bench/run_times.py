#!/usr/bin/python3
"""run_times.py [BUILD]: the run times that `fit-params --check` expects, and what the fit and the
effect selection then take. The recordings are those of honesty.py and of configs/jobs. Run it on a
machine that does nothing else."""
import collections
import json
import pathlib
import subprocess
import sys
import tempfile
import time

from honesty import ROOT, SITUATIONS, write_situation

BUILD = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "release").resolve()
EXAMPLES = ("paper", "paper-move", "close-loop", "screw", "screw-viscous", "payload")
LIMIT = ("--time-limit", "200")  # s


def run(job, *options):
    """The JSON, or nothing where there is none, and the time."""
    begin = time.monotonic()
    command = [BUILD / "apps" / "fit-params", job.name, "--json", *options]
    result = subprocess.run(command, cwd=job.parent, capture_output=True, text=True)
    taken = time.monotonic() - begin
    return json.loads(result.stdout) if result.stdout else None, taken


def compare(name, job, ratios):
    check, _ = run(job, "--check")
    fit, of_fit = run(job, *LIMIT)
    if check is None or fit is None or fit["grade"] in ("not_converged", "nothing_determined"):
        return
    loop, of_loop = run(job, "--close-loop", *LIMIT)
    fits = "explained" if fit["grade"] == "explained" else "unexplained"
    if loop and loop["grade"] == "explained":
        loops = "nothing_missing" if fits == "explained" else "one_effect"
    else:
        loops = "no_effect"
    for outcome, taken in ((fits, of_fit), ("close_loop_" + loops, of_loop)):
        expected = check["expected_time_s"][outcome]
        ratios[outcome].append(taken / expected)
        print(f"{name:<28}{outcome:<28}{expected:9.2f}{taken:9.2f}{taken / expected:7.2f}")
    sys.stdout.flush()


def main():
    ratios = collections.defaultdict(list)
    print(f"{'recordings':<28}{'outcome':<28}{'expected':>9}{'taken, s':>9}{'ratio':>7}")
    for name in SITUATIONS:
        with tempfile.TemporaryDirectory() as folder:
            write_situation(name, pathlib.Path(folder))
            compare(name, pathlib.Path(folder, "job.yaml"), ratios)
    for name in EXAMPLES:
        compare(name, ROOT / "configs" / "jobs" / f"{name}.yaml", ratios)
    print(f"\n{'outcome':<28}{'runs':>6}{'within a factor of 3':>22}{'within 10':>11}")
    for outcome, all_of_it in sorted(ratios.items()):
        within = [sum(1 / f <= r <= f for r in all_of_it) for f in (3, 10)]
        print(f"{outcome:<28}{len(all_of_it):>6}{within[0]:>22}{within[1]:>11}")


main()
