#!/usr/bin/python3
"""fleet.py [BUILD [AXES [NIGHTS [SEED]]]]: how early axisfit-fleet tells of wear, and how often of none.

A factory of `simulate-fleet`, of which three axes in ten wear, is fitted on two threads. False is an alarm of an axis
that does not wear, or does not yet; of worn axes counted is the first night on which there is an alarm."""
import collections
import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import time

PROJECT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else PROJECT / "build" / "release").resolve() / "apps"
AXES, NIGHTS, SEED = (int(sys.argv[i]) if len(sys.argv) > i else d for i, d in ((2, 60), (3, 30), (4, 1)))


def run(*command, folder):
    return subprocess.run([str(c) for c in command], cwd=folder, check=True, capture_output=True, text=True).stdout


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        run(BUILD / "simulate-fleet", "factory", "--axes", AXES, "--nights", NIGHTS, "--seed", SEED, folder=folder)
        own = folder / "factory"
        times = [time.monotonic()]
        for command in (["plan", "fleet.yaml"], ["work", "plan", "--threads", 2], ["merge", "plan"]):
            run(BUILD / "axisfit-fleet", *command, folder=own)
            times.append(time.monotonic())
        report = json.loads(run(BUILD / "axisfit-fleet", "report", "fleet.yaml", "--json", folder=own))
        times.append(time.monotonic())
        plan, work, merge, told = (b - a for a, b in zip(times, times[1:]))
        print(f"{report['results']} results, {report['failed']} failed: plan {plan:.1f} s, work {work:.0f} s, merge "
              f"{merge:.1f} s, report {told:.1f} s\n")
        truth = {row["axis"]: row for row in csv.DictReader((own / "truth.csv").open())}
        nights = sorted({p.stem for p in (own / "recordings").rglob("*.csv")})
        quiet = sum(not truth[p.parent.name]["since"] or p.stem < truth[p.parent.name]["since"]
                    for p in (own / "recordings").rglob("*.csv"))
    found = [a for a in report["alarms"] if a["kind"] in ("parameter", "effect")]
    early = [a for a in found if not truth[a["axis"]]["since"] or a["night"] < truth[a["axis"]]["since"]]
    print(f"{len(early)} false alarms in {quiet} axis-nights: {1000 * len(early) / quiet:.2f} per thousand\n")
    delays = collections.defaultdict(list)
    for axis, row in truth.items():
        if row["wear"] != "none":
            later = [nights.index(a["night"]) - nights.index(row["since"]) + 1 for a in found
                     if a["axis"] == axis and a["night"] >= row["since"]]
            delays[row["wear"]].append(min(later, default=math.inf))
    print("| wear | axes | told within 3 nights | told at all |\n|---|---|---|---|")
    for wear, told in sorted(delays.items()):
        print(f"| {wear} | {len(told)} | {sum(d <= 3 for d in told)} | {sum(d < math.inf for d in told)} |")


if __name__ == "__main__":
    main()
