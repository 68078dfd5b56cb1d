#!/usr/bin/python3
"""screw.py [BUILD]: how far fits of configs/jobs/screw.yaml end from the truth behind
testdata/screw, whose recordings are made anew with other seeds: root mean square and mean of the
errors, in standard errors, with the 2 mA of noise that the current has there and with ten times
that."""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "release").resolve()
SCREW = ROOT / "testdata" / "screw"
SEEDS = 30
LEAD = 1.5915494e-3  # m/rad
TRUTH = {  # testdata/README.md
    "M": 62.0 + 6e-5 / LEAD**2,
    "B_a": 180.0 + 2e-4 / LEAD**2,
    "coulomb_friction.F_c": 35.0,
    "constant_force.F_0": -6.0,
}


def record(motion, seed, noise, folder):
    axis = pathlib.Path(folder, "truth.yaml")
    axis.write_text((SCREW / "truth.yaml").read_text().replace("noise: 2 mA", f"noise: {noise}"))
    text = subprocess.run(
        [BUILD / "apps" / "simulate-axis", axis, SCREW / f"{motion}.yaml", "--rate", "2000",
         "--seed", str(seed), "--signals", "position", "motor_current"],
        check=True, capture_output=True, text=True).stdout  # fmt: skip
    columns = [line.split(",") for line in text.splitlines()]
    rows = [",".join([time, *signals]) for time, _, *signals in columns]  # without the command
    pathlib.Path(folder, f"{motion}.csv").write_text("\n".join(rows) + "\n")


def errors(seed, noise):
    with tempfile.TemporaryDirectory() as root:
        folder = pathlib.Path(root, "testdata", "screw")  # as the job names it, from configs/jobs
        folder.mkdir(parents=True)
        record("sweep", 2 * seed, noise, folder)
        record("move", 2 * seed + 1, noise, folder)
        done = subprocess.run(
            [BUILD / "apps" / "fit-params", ROOT / "configs" / "jobs" / "screw.yaml", "--data",
             pathlib.Path(root, "configs", "jobs"), "--json"],
            check=True, capture_output=True, text=True)  # fmt: skip
    parameters = {p["name"]: p for p in json.loads(done.stdout)["parameters"]}
    return {name: (parameters[name]["value"] - truth) / parameters[name]["standard_error"]
            for name, truth in TRUTH.items()}  # fmt: skip


print(f"{'':<27} {'rms':>6} {'mean':>6}")
for noise in ("2 mA", "20 mA"):
    found = [errors(seed, noise) for seed in range(100, 100 + SEEDS)]
    for name in TRUTH:
        of_name = [e[name] for e in found]
        rms = math.sqrt(sum(e * e for e in of_name) / SEEDS)
        print(f"{noise:>5}  {name:<20} {rms:>6.2f} {sum(of_name) / SEEDS:>+6.2f}", flush=True)
