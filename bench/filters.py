#!/usr/bin/python3
"""filters.py [BUILD] [--seeds N] [--jobs N]: fits of recordings that were filtered or held.

The paper's axis is simulated here, by fixed steps, not by the program that is measured, and so are
the filters. Each recording is fitted as if it had not been filtered, and with the filter declared.
The tables give the mean estimate, the mean and the largest distance from the truth in standard
errors, and how many of the 95 % intervals contain the truth; and how many recordings are warned
of."""
import argparse
import concurrent.futures
import json
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
RATE, SECONDS = 1000, 1.2
NOISE = {"velocity": 0.002, "acceleration": 0.05}
UNITS = {"command": "V", "velocity": "m/s", "acceleration": "m/s^2"}
AXIS = {"R": 0.56, "L": 2.35e-3, "K_e": 0.289, "K_m": 0.289, "J_m": 8.47e-4, "B_m": 7.33e-4,
        "K_t": 0.0668, "r_g": 5.73e-3, "H": 1e-5, "M": 146.0, "T_z": 7.05e-3, "T_p": 0.04,
        "T_r": 1.59e-4, "K_1": 1014.2, "K_2": 870.0, "K_i": 3.0, "V_s": 95.0, "V_L": 2.7,
        "B_a": 200.0, "b_g": 1500.0, "k_g": 5e6, "F_s": 30.0, "w": 2e-3, "K_v": 1000.0}  # fmt: skip
AXIS_UNITS = {"R": "ohm", "L": "H", "K_e": "V s/rad", "K_m": "N m/A", "J_m": "kg m^2",
              "B_m": "N m s/rad", "K_t": "V s/rad", "r_g": "m", "H": "m", "M": "kg", "T_z": "s",
              "T_p": "s", "T_r": "s", "K_1": "", "K_2": "", "K_i": "A/V", "V_s": "V", "V_L": "V",
              "B_a": "N s/m", "b_g": "N s/m", "k_g": "N/m", "F_s": "N", "w": "m/s",
              "K_v": ""}  # fmt: skip
START = {"V_L": 1.3, "B_a": 0.7, "b_g": 1.4, "k_g": 0.7, "T_p": 1.3}  # over the truth


def levels(rng):
    """Set-velocity voltages over time: levels of random size and sign, and zero at the end."""
    steps, t, sign = [(0.0, 0.0)], 0.05, rng.choice((-1, 1))
    while t < SECONDS - 0.15:
        steps.append((t, sign * round(rng.uniform(2.4, 8.0), 2)))
        t += round(rng.uniform(0.12, 0.25), 3)
        sign = -sign
    steps.append((t, 0.0))
    return lambda now: next(u for begin, u in reversed(steps) if now >= begin - 1e-9)


def axis(drive, steps=200):
    """The equations of docs/model.md by the implicit Euler method."""
    p = AXIS
    log = {name: [] for name in ("time", "command", "velocity", "acceleration")}
    h = 1.0 / (RATE * steps)
    J, M, r, H, k_g, b_g = (p[n] for n in ("J_m", "M", "r_g", "H", "k_g", "b_g"))
    K_m, K_e, K_v, L, V_s, V_L = (p[n] for n in ("K_m", "K_e", "K_v", "L", "V_s", "V_L"))
    T_z, F_s, w_s, back = p["T_z"], p["F_s"], p["w"], p["K_2"] * p["K_t"]
    c5 = h / (p["T_p"] * p["T_r"])
    d5 = 1.0 + c5 * (p["T_p"] + p["T_r"])
    d6, c6 = 1.0 + h / L * (p["R"] + K_v / p["K_i"]), K_v / p["K_i"]
    d6_limited, dw, dv = 1.0 + h / L * p["R"], 1.0 + h * p["B_m"] / J, 1.0 + h * p["B_a"] / M
    y = v = th = w = y4 = y5 = i = a = 0.0
    for k in range(round(SECONDS * RATE) + 1):
        u = drive(k / RATE)
        for name, value in zip(log, (k / RATE, u, v, a)):
            log[name].append(value)
        for _ in range(steps):
            y5 = (y5 + c5 * (p["K_1"] * u - back * w - y4)) / d5
            y4 += h * y5
            V_c = min(max(y4 + T_z * y5, -V_L), V_L)
            emf = K_e * w
            new = (i + h / L * (K_v * V_c - emf)) / d6
            V_m = K_v * V_c - c6 * new
            if abs(V_m) > V_s:
                new = (i + h / L * (math.copysign(V_s, V_m) - emf)) / d6_limited
            i = new
            x = r * th - y
            gap = x - H if x > H else x + H if x < -H else 0.0
            f = k_g * gap + b_g * (r * w - v) if gap else 0.0
            w = (w + h / J * (K_m * i - r * f)) / dw
            slid = (v + h / M * f) / dv
            stop = h / M * (F_s if abs(v) < w_s else 0.0) / dv
            new = math.copysign(max(abs(slid) - stop, 0.0), slid)
            a = (new - v) / h
            v = new
            y += h * v
            th += h * w
    return log


# What recorders do, and how a job says it.


def average(x):
    return [math.fsum(x[max(k - 10, 0) : k + 11]) / len(x[max(k - 10, 0) : k + 11])
            for k in range(len(x))]  # fmt: skip


def second_order(x, cutoff=80.0):
    """A Butterworth filter of the second order by the bilinear transform, at rest at first."""
    w = 2.0 * math.pi * cutoff / RATE
    alpha, c = math.sin(w) / math.sqrt(2.0), math.cos(w)
    b, a1, a2 = 0.5 * (1.0 - c) / (1.0 + alpha), -2.0 * c / (1.0 + alpha), (1 - alpha) / (1 + alpha)
    y = []
    for k in range(len(x)):
        x1, x2 = x[max(k - 1, 0)], x[max(k - 2, 0)]
        y1, y2 = (y[k - 1] if k > 0 else x[0]), (y[k - 2] if k > 1 else x[0])
        y.append(b * (x[k] + 2.0 * x1 + x2) - a1 * y1 - a2 * y2)
    return y


RECORDERS = {
    "none": (lambda x: x, {}),
    "zero-phase moving average of 21": (
        average, {"filter": {"moving_average": 21, "zero_phase": True}}),
    "causal Butterworth, second order, 80 Hz": (
        second_order, {"filter": {"butterworth": {"order": 2, "cutoff": "80 Hz"}}}),
    "hold of 10": (lambda x: [x[k - k % 10] for k in range(len(x))], {"hold": 10}),
}  # fmt: skip


def fit(build, record, declared):
    """result.json of a fit."""
    with tempfile.TemporaryDirectory() as folder:
        rows = [",".join(record)]
        rows += [",".join(f"{x:.9g}" for x in row) for row in zip(*record.values())]
        pathlib.Path(folder, "data.csv").write_text("\n".join(rows) + "\n")
        amount = {n: f"{x:.9g} {AXIS_UNITS[n]}" if AXIS_UNITS[n] else x for n, x in AXIS.items()}
        axis_file = {"drive": "velocity_loop", "transmission": "backlash", "parameters": amount}
        signals = {s: {"column": s, "unit": unit, **(declared if s in NOISE else {})}
                   for s, unit in UNITS.items()}  # fmt: skip
        free = {n: {"initial": f"{k * AXIS[n]:.9g} {AXIS_UNITS[n]}"} for n, k in START.items()}
        recording = {"file": "data.csv", "time": {"column": "time", "unit": "s"},
                     "signals": signals}  # fmt: skip
        job = {"axis": "axis.yaml", "recordings": [recording], "free": free}
        for name, text in (("axis.yaml", axis_file), ("job.yaml", job)):
            pathlib.Path(folder, name).write_text(json.dumps(text))
        command = [f"{build}/apps/fit-params", f"{folder}/job.yaml", "--output", f"{folder}/out"]
        run = subprocess.run(command, capture_output=True, text=True)
        if run.returncode == 2:  # 3: not usable, which is a result
            sys.exit(run.stdout + run.stderr)
        return json.loads(pathlib.Path(folder, "out/result.json").read_text())


def fits_of(build, seed):
    """result.json by recorder and whether it is declared, of one simulated motion."""
    rng = random.Random(seed)
    log = axis(levels(rng))
    noisy = {s: [x + rng.gauss(0.0, NOISE.get(s, 0.0)) for x in log[s]] for s in log}
    results = {}
    for name, (recorder, declared) in RECORDERS.items():
        record = {s: recorder(x) if s in NOISE else x for s, x in noisy.items()}
        for known in (False, True) if declared else (True,):
            results[name, known] = fit(build, record, declared if known else {})
    return results


def table(results):
    rows = ["| | estimate / truth | mean distance | largest | intervals with the truth |",
            "|---|---|---|---|---|"]  # fmt: skip
    inside = determined = 0
    for name in START:
        found = [p for r in results for p in r["parameters"] if p["name"] == name]
        sure = [p for p in found if p["standard_error"]]
        ratio = sum(p["value"] for p in found) / len(found) / AXIS[name]
        distance = [abs(p["value"] - AXIS[name]) / p["standard_error"] for p in sure]
        count = sum(p["confidence_interval"][0] <= AXIS[name] <= p["confidence_interval"][1] for p in sure)
        inside, determined = inside + count, determined + len(sure)
        rows.append(f"| {name} | {ratio:.4f} | {sum(distance) / len(sure):.2f} | "
                    f"{max(distance):.1f} | {count} of {len(sure)} |")  # fmt: skip
    rows.append(f"| all | | | | {100.0 * inside / determined:.1f} % |")
    return "\n".join(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", nargs="?", default=ROOT / "build/release")
    parser.add_argument("--seeds", type=int, default=24)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    given = parser.parse_args()
    with concurrent.futures.ProcessPoolExecutor(given.jobs) as pool:
        runs = list(pool.map(fits_of, [given.build] * given.seeds, range(given.seeds)))
    print(f"`bench/filters.py --seeds {given.seeds}`\n")
    print(f"Velocity and acceleration of the paper's axis, {given.seeds} recordings.")
    for name, known in runs[0]:
        results = [run[name, known] for run in runs]
        warned = sum(any("Set '" in w for w in r["recordings"][0]["warnings"]) for r in results)
        grades = [r["grade"] for r in results]
        grades = ", ".join(f"{g} {grades.count(g)}" for g in sorted(set(grades)))
        declared = "" if name == "none" else ", declared" if known else ", not declared"
        print(f"\n## {name[0].upper()}{name[1:]}{declared}\n")
        print(f"Warned of: {warned} of {len(results)}. Grades: {grades}.\n\n{table(results)}")


if __name__ == "__main__":
    main()
