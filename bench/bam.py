#!/usr/bin/env python3
"""How well the published models of BAM follow its pendulum servo from the goal positions alone.

Usage: bench/bam.py FOLDER, with the recordings of an XL330 (github.com/Rhoban/bam, bam/data.bak/raw) as CSV.

Prints root mean square and mean absolute errors of the position in mrad, as fit-params does for
configs/jobs/bam-m1.yaml to bam-m6.yaml. The simulation is one of its own, with steps of 1 ms: torque
k_t (U - k_t w) / R, friction that sticks, of a base, of the load |external - motor torque|, and of the
load times exp(-(w / w_s)^alpha). The parameters are the published ones.
"""

import argparse
import csv
import json
import math
import pathlib
import subprocess
import tempfile

MODELS = {
    "m1": {"k_t": 0.38670, "R": 4.0171, "armature": 0.0018142, "base": 0.012833, "viscous": 0.0036617},
    "m4": {"k_t": 0.38617, "R": 3.4026, "armature": 0.0018955, "base": 0.0087586, "viscous": 0.0046210,
           "load": 0.06803, "load_stribeck": 0.07381, "w_s": 2.558, "alpha": 0.760},
}
ROOT = pathlib.Path(__file__).resolve().parent.parent
JOBS = ("m1", "m2", "m3", "m4", "m6")
GAINS = {100: "sin_sin_0 up_and_down_2 sin_time_square_3", 400: "sin_sin_8 up_and_down_10 sin_time_square_11",
         200: "sin_sin_4 up_and_down_6 sin_time_square_7"}
SUPPLY = 7.3  # V
INERTIA, WEIGHT = 0.49 * 0.1**2, 0.49 * 9.81 * 0.1  # kg m^2, N m
STEP = 1e-3  # s


def simulate(model, gain, times, goals, start):
    """The positions at the times, rad."""
    duty_per_radian = gain * 4096 / (2 * math.pi) / (256 * 885)
    inertia = INERTIA + model["armature"]
    q, w, t, positions = start, 0.0, times[0], []
    for i, until in enumerate(times):
        while t + 0.5 * STEP < until:
            duty = max(-1.0, min(1.0, duty_per_radian * (goals[i - 1] - q)))
            motor = model["k_t"] * (duty * SUPPLY - model["k_t"] * w) / model["R"]
            external = -WEIGHT * math.sin(q)
            load = abs(external - motor)
            friction = model["base"] + model.get("load", 0.0) * load + model["viscous"] * abs(w)
            if "load_stribeck" in model:
                friction += model["load_stribeck"] * load * math.exp(-((abs(w) / model["w_s"]) ** model["alpha"]))
            stopping = -(inertia * w / STEP + motor + external)
            w += STEP * (motor + external + max(-friction, min(friction, stopping))) / inertia
            q += STEP * w
            t += STEP
        positions.append(q)
    return positions


def fitted_errors(build, job, folder):
    """The errors of a job's simulations by the names of its recordings, rad."""
    with tempfile.TemporaryDirectory() as results:
        subprocess.run([build / "apps" / "fit-params", ROOT / "configs" / "jobs" / f"bam-{job}.yaml",
                        "--data", folder, "--output", results], stdout=subprocess.DEVNULL, check=False)
        names = [r["name"] for r in json.loads((pathlib.Path(results) / "result.json").read_text())["recordings"]]
        errors = {name: [] for name in names}
        with open(pathlib.Path(results) / "residuals.csv", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                errors[names[int(row["recording"]) - 1]].append(float(row["position_residual"]))
    return errors


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--fit", type=pathlib.Path, metavar="BUILD", help="the jobs bam-m1 to bam-m6 as well")
    arguments = parser.parse_args()
    folder = arguments.folder
    fitted = {job: fitted_errors(arguments.fit, job, folder) for job in JOBS} if arguments.fit else {}
    columns = [*fitted, *(f"published {name}" for name in MODELS)]
    print(f"{'mrad, rms | mean':20}" + "".join(f"{name:>16}" for name in columns))
    for gain, names in GAINS.items():
        for name in names.split():
            with open(folder / f"{name}.csv", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
            times, goals, measured = ([float(row[key]) for row in rows]
                                      for key in ("timestamp", "goal_position", "position"))
            line = f"{name:20}"
            of_models = [[a - b for a, b in zip(simulate(model, gain, times, goals, measured[0]), measured)]
                         for model in MODELS.values()]
            for errors in [*(by_name[name] for by_name in fitted.values()), *of_models]:
                rms = math.sqrt(sum(e * e for e in errors) / len(errors))
                line += f"{1e3 * rms:8.1f} |{1e3 * sum(map(abs, errors)) / len(errors):6.1f}"
            print(line)


if __name__ == "__main__":
    main()
