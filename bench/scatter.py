#!/usr/bin/python3
"""scatter.py [BUILD [MACHINES]]: do the intervals hold the machine's parameters when these differ from recording
to recording?

Slides of 20 kg, give or take a third, under a servo drive, with Coulomb and viscous friction. From recording to
recording friction scatters by 5 %, a constant force by 1 N, the drive's constant by 1 %; or all by a hundredth of that,
which is as little as the errors of one recording; or nothing does.
Simulated here and not by the project: midpoint steps of 50 us, friction that sticks, an encoder of 1 um, a force
with noise. MACHINES (default 60) machines with 3, 5 and 10 recordings each. Counted is how often the 95 %
intervals of mass, viscous and Coulomb friction and constant force hold those of the machine, and how often those
do that are within recordings; and how wide they are where nothing scatters, over those within."""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

BUILD = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build/release").resolve()
MACHINES = int(sys.argv[2]) if len(sys.argv) > 2 else 60
SAMPLE, STEPS, SECONDS = 4e-3, 80, 4.0
SAMPLES = int(SECONDS / SAMPLE)
NAMES = {"M": "mass", "B_a": "viscous", "coulomb_friction.F_c": "coulomb", "constant_force.F_0": "offset"}
AXIS = """drive: force_source
transmission: rigid
parameters: {K_f: 1 N/V, M: 20 kg, B_a: 50 N s/m}
effects: {coulomb_friction: {F_c: 10 N}, constant_force: {F_0: 0 N}}
"""


def simulate(rng, mass, viscous, coulomb, offset, friction_at=lambda time: 1.0):
    """All recordings at once: measured forces and positions by sample. `friction_at` tells by what friction is
    multiplied at a time."""
    n = len(mass)
    t = np.arange(SAMPLES) * SAMPLE
    f, phase = rng.uniform(0.2, 1.5, (n, 3)), rng.uniform(0, 2 * np.pi, (n, 3))
    begin = np.clip(t / 0.5, 0, 1) ** 3
    path = 0.1 * begin * np.sin(2 * np.pi * f[:, :, None] * t + phase[:, :, None]).sum(1)
    speed = np.gradient(path, SAMPLE, axis=1)
    h, y, v, force = SAMPLE / STEPS, np.zeros(n), np.zeros(n), np.zeros(n)
    forces, places = [], []
    for k in range(SAMPLES):
        forces.append(force.copy())
        places.append(y.copy())
        after = 20.0 * (900.0 * (path[:, k] - y) + 42.0 * (speed[:, k] - v))
        worn = friction_at(t[k])
        for part in range(STEPS):
            push = force + (part + 0.5) / STEPS * (after - force) + offset
            free = v + 0.5 * h * (push - worn * viscous * v) / mass  # midpoint, without dry friction
            stop = worn * coulomb * h / mass
            end = v + h * (push - worn * viscous * free) / mass
            end = np.sign(end) * np.maximum(np.abs(end) - stop, 0.0)
            y = y + 0.5 * h * (v + end)
            v = end
        force = after
    return np.array(forces).T + 0.2 * rng.standard_normal((n, SAMPLES)), np.floor(np.array(places).T * 1e6) * 1e-6


def draw(rng):
    """A machine."""
    return {"mass": 20.0 * rng.uniform(0.7, 1.3), "viscous": 50.0 * rng.uniform(0.7, 1.3),
            "coulomb": 10.0 * rng.uniform(0.7, 1.3), "offset": rng.uniform(-5.0, 5.0)}


def record(rng, machine, scatters, count):
    """Recordings of it: measured forces and positions."""
    gain = 1.0 + scatters * 0.01 * rng.standard_normal(count)
    friction = 1.0 + scatters * 0.05 * rng.standard_normal(count)
    offset = machine["offset"] + scatters * rng.standard_normal(count)
    # What the drive's constant scales, everything that is measured by it has the inverse of.
    forces, places = simulate(rng, np.full(count, machine["mass"]), machine["viscous"] * friction,
                              machine["coulomb"] * friction, offset)
    return forces / gain[:, None], places


def write_job(folder, forces, places, roles=None):
    """The name of a job for these recordings."""
    (folder / "axis.yaml").write_text(AXIS)
    job = "axis: axis.yaml\nrecordings:\n"
    t = np.arange(SAMPLES) * SAMPLE
    for i, (force, place) in enumerate(zip(forces, places)):
        rows = "\n".join(f"{a:.4f},{b:.5g},{c:.6f}" for a, b, c in zip(t, force, place))
        (folder / f"run-{i}.csv").write_text("t,force,position\n" + rows + "\n")
        job += (f"  - {{file: run-{i}.csv, role: {roles[i] if roles else 'fit'}, time: {{column: t, unit: s}}, "
                "initial_state: data, signals: {drive_force: {column: force, unit: N}, position: {column: position, "
                "unit: m}}}\n")
    job += "free: {M: {}, B_a: {}, coulomb_friction.F_c: {}, constant_force.F_0: {bounds: [-50 N, 50 N]}}\n"
    (folder / "job.yaml").write_text(job + "fit: {observer: {fixed: 30 1/s}}\n")
    return "job.yaml"


def fit(forces, places):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        done = subprocess.run([BUILD / "apps" / "fit-params", write_job(folder, forces, places), "--json"], cwd=folder,
                              capture_output=True, text=True, check=False)
        return json.loads(done.stdout) if done.stdout else sys.exit(done.stderr)


def main():
    print("| scatter | recordings | intervals hold | those within hold | width over within, median | mean |\n"
          "|---|---|---|---|---|---|")
    for scatters in (1.0, 0.01, 0.0):
        for count in (3, 5, 10):
            rng = np.random.default_rng(count + round(100 * scatters))
            held = narrow = total = 0
            widths = []
            for _ in range(MACHINES):
                machine = draw(rng)
                result = fit(*record(rng, machine, scatters, count))
                within = {p["name"]: p["standard_error_within"] for p in result["scatter"]["parameters"]}
                for p in result["parameters"]:
                    truth, error = machine[NAMES[p["name"]]], within[p["name"]]
                    total += 1
                    held += p["confidence_interval"][0] <= truth <= p["confidence_interval"][1]
                    narrow += abs(p["value"] - truth) < 1.96 * error
                    widths.append((p["confidence_interval"][1] - p["confidence_interval"][0]) / (2 * 1.96 * error))
            print(f"| {scatters:g} | {count} | {100 * held / total:.1f} % | "
                  f"{100 * narrow / total:.1f} % | {np.median(widths):.2f} | {np.mean(widths):.2f} |", flush=True)


if __name__ == "__main__":
    main()
