#!/usr/bin/python3
"""fleet.py [BUILD [AXES [NIGHTS [SEED]]]]: how early axisfit-fleet tells of wear, and how often of none.

Two factories of `simulate-fleet`, one in which nothing wears and one in which every axis does, are fitted on two
threads. A false alarm is one of an axis that is as it was; of worn axes counted is the first night on which any alarm
is given whose change begins no earlier than two nights before the wear."""
import collections
import csv
import json
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


def alarms(folder, worn):
    run(BUILD / "simulate-fleet", "factory", "--axes", AXES, "--nights", NIGHTS, "--seed", SEED, "--worn", worn,
        folder=folder)
    own = folder / "factory"
    begin = time.monotonic()
    run(BUILD / "axisfit-fleet", "plan", "fleet.yaml", folder=own)
    planned = time.monotonic()
    run(BUILD / "axisfit-fleet", "work", "plan", "--threads", 2, folder=own)
    worked = time.monotonic()
    run(BUILD / "axisfit-fleet", "merge", "plan", folder=own)
    report = json.loads(run(BUILD / "axisfit-fleet", "report", "fleet.yaml", "--json", folder=own))
    end = time.monotonic()
    truth = {row["axis"]: row for row in csv.DictReader((own / "truth.csv").open())}
    nights = sorted({p.stem for p in (own / "recordings").rglob("*.csv")})
    print(f"{report['results']} results, {report['failed']} failed: plan {planned - begin:.1f} s, work "
          f"{worked - planned:.1f} s, merge and report {end - worked:.1f} s\n")
    return [a for a in report["alarms"] if a["kind"] in ("parameter", "effect")], truth, nights, report["results"]


def main():
    with tempfile.TemporaryDirectory() as name:
        found, _, _, results = alarms(pathlib.Path(name), 0)
        print(f"{len(found)} false alarms in {results} axis-nights of axes that stay as they are.\n")
    with tempfile.TemporaryDirectory() as name:
        found, truth, nights, _ = alarms(pathlib.Path(name), 1)
        early, table = 0, collections.defaultdict(list)
        for axis, row in truth.items():
            since = nights.index(row["since"])
            delays = []
            for a in (a for a in found if a["axis"] == axis):
                if nights.index(a["since"]) < since - 2:
                    early += nights.index(a["night"]) < since
                elif nights.index(a["night"]) >= since:
                    delays.append((nights.index(a["night"]) - since + 1, a["what"]))
            table[row["wear"]].append(min(delays, default=(None, "")))
        print("| wear | axes | told within 3 nights | told at all | by what, first |\n|---|---|---|---|---|")
        for wear, told in sorted(table.items()):
            soon = sum(1 for d, _ in told if d is not None and d <= 3)
            first = collections.Counter(w for d, w in told if d is not None).most_common(2)
            print(f"| {wear} | {len(told)} | {soon} | {sum(d is not None for d, _ in told)} | "
                  f"{', '.join(f'{w} ({n})' for w, n in first)} |")
        print(f"\n{early} alarms before anything had happened.")


if __name__ == "__main__":
    main()
