#!/usr/bin/python3
"""coupled_axes.py [BUILD [COUPLED [ALONE]]]: does `--close-loop` name what axes do to each other?

Three axes of 14, 9 and 5 kg, give or take a fifth, under servo drives, of which the drive forces and the
positions of the encoders were recorded, in one file. x and y share an inertia of 2 % of their masses in COUPLED
machines (default 10), and nothing in ALONE machines (default 50); in every second machine a drag of 1.8th power
that no job has acts besides. Simulated here and not by the project: the joint equations of all three,
Runge-Kutta steps of 50 us, dry friction as a steep tanh. The jobs have the accelerations of the other axes as
channels, which are second derivatives of their encoders.

With `--write FOLDER`: the recordings of the first coupled machine.
"""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
RATE, STEPS, SECONDS = 250, 80, 8.0
SAMPLES = int(SECONDS * RATE)
AXES = "xyz"


def demands(rng):
    """Position, speed and acceleration that the drives are asked for, by axis and sample."""
    t = np.arange(SAMPLES) / RATE
    u = np.clip(t / 0.6, 0.0, 1.0)
    paths = []
    for reach in (0.5, 0.6, 0.3):
        f, phase = rng.uniform(0.15, 0.95, 3), rng.uniform(0, 2 * np.pi, 3)
        place = np.sin(2 * np.pi * f[:, None] * t + phase[:, None]).mean(0) * reach
        place = place * u**3 * (10.0 - 15.0 * u + 6.0 * u**2)
        speed = np.gradient(place, 1.0 / RATE)
        paths.append((place, speed, np.gradient(speed, 1.0 / RATE)))
    return np.array(paths)


def draw(rng, shared, dragged):
    mass = np.array([14.0, 9.0, 5.0]) * rng.uniform(0.8, 1.2, 3)
    return {"mass": mass, "viscous": np.array([50.0, 35.0, 20.0]) * rng.uniform(0.7, 1.3, 3),
            "coulomb": np.array([9.0, 6.0, 4.0]) * rng.uniform(0.7, 1.3, 3),
            "shared": 0.02 * np.sqrt(mass[0] * mass[1]) if shared else 0.0,
            "drag": np.array([6.0, 5.0, 3.0]) * rng.uniform(0.5, 1.5, 3) if dragged else np.zeros(3)}


def simulate(machines, paths):
    """All runs at once: positions and forces by run, sample and axis."""
    stack = lambda name: np.stack([m[name] for m in machines])
    mass, viscous, coulomb, drag = (stack(n) for n in ("mass", "viscous", "coulomb", "drag"))
    shared = stack("shared")
    path = np.stack(paths).transpose(3, 2, 0, 1)  # sample, kind, run, axis
    det = mass[:, 0] * mass[:, 1] - shared**2
    h, bandwidth = 1.0 / (RATE * STEPS), 20.0
    y, v, force = (np.zeros_like(mass) for _ in range(3))
    places, forces = [], []

    def rates(speed, push):
        f = push - viscous * speed - coulomb * np.tanh(speed / 1e-4)
        f -= drag * np.abs(speed) ** 1.8 * np.sign(speed)
        a = f / mass
        a[:, 0] = (f[:, 0] * mass[:, 1] - shared * f[:, 1]) / det
        a[:, 1] = (mass[:, 0] * f[:, 1] - shared * f[:, 0]) / det
        return a

    for k in range(SAMPLES):
        places.append(y.copy())
        forces.append(force.copy())
        place, speed, acceleration = path[k]
        after = mass * (acceleration + bandwidth**2 * (place - y) + 2.0 * bandwidth * (speed - v))
        slope = (after - force) / STEPS
        for part in range(STEPS):
            first, middle, last = (force + slope * (part + s) for s in (0.0, 0.5, 1.0))
            a = rates(v, first)
            v2 = v + 0.5 * h * a
            b = rates(v2, middle)
            v3 = v + 0.5 * h * b
            c = rates(v3, middle)
            v4 = v + h * c
            d = rates(v4, last)
            y = y + h / 6.0 * (v + 2.0 * (v2 + v3) + v4)
            v = v + h / 6.0 * (a + 2.0 * (b + c) + d)
        force = after
    return np.stack(places, 1), np.stack(forces, 1)


def write(path, rng, places, forces):
    """One file of all axes: measured forces, and encoders of 1 um."""
    columns = {"t": np.arange(SAMPLES) / RATE}
    for a, axis in enumerate(AXES):
        columns[f"{axis}_force"] = forces[:, a] + 0.05 * rng.standard_normal(SAMPLES)
        columns[f"{axis}_position"] = np.floor(1e6 * places[:, a]) / 1e3
    rows = [",".join(columns)]
    rows += [",".join(f"{x:.6g}" for x in row) for row in zip(*columns.values())]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")


def run(build, folder):
    job = pathlib.Path("configs") / "jobs" / "three-axes.yaml"
    shutil.copytree(ROOT / job.parent, folder / job.parent)
    done = subprocess.run([build / "apps" / "fit-params", folder / job, "--close-loop", "--json",
                           "--time-limit", "300"], capture_output=True, text=True, check=False)
    if not done.stdout:
        sys.exit(done.stderr)
    return json.loads(done.stdout)


def accepted(result):
    """Names of accepted effects that are related to a channel, and of all others."""
    names = [e["name"] for e in result.get("effects", []) if e["accepted"]]
    return [n for n in names if n.startswith("channel_")], [n for n in names if not n.startswith("channel_")]


def main():
    arguments = sys.argv[1:]
    folder = pathlib.Path(arguments[arguments.index("--write") + 1]) if "--write" in arguments else None
    if folder:
        arguments = [".", "1", "0"]
    build = pathlib.Path(arguments[0] if arguments else ROOT / "build" / "release").resolve()
    coupled, alone = (int(arguments[i]) if len(arguments) > i else n for i, n in ((1, 10), (2, 50)))
    machines = [draw(np.random.default_rng(1000 + i), i < coupled, i % 2 == 1) for i in range(coupled + alone)]
    seeds = [np.random.default_rng([i, run]) for i in range(len(machines)) for run in (0, 1)]
    places, forces = simulate([m for m in machines for _ in (0, 1)], [demands(rng) for rng in seeds])
    right = false = 0
    print("| machine | shared, kg | accepted | of x, kg | of y, kg |\n|---|---|---|---|---|")
    for i, machine in enumerate(machines):
        with tempfile.TemporaryDirectory() as made:
            target = folder or pathlib.Path(made) / "testdata"
            target.mkdir(exist_ok=True)
            for part, name in enumerate(("fit", "validate")):
                at = 2 * i + part
                write(target / f"three-axes-{name}.csv", seeds[at], places[at], forces[at])
            if folder:
                return
            results = run(build, pathlib.Path(made))
        found = {axis: accepted(result) for axis, result in results["axes"].items()}
        said = {n for axis in found for n in (f"{axis}: {e}" for e in found[axis][0])}
        shown = results["shared_inertias"]
        wanted = {"x: channel_force.y_acceleration", "y: channel_force.x_acceleration"}
        if i < coupled:
            values = [shown[0][axis] for axis in "xy"] if shown else []
            near = len(values) == 2 and all(
                abs(v["value"] - machine["shared"]) < 4.0 * v["standard_error"] for v in values)
            right += said == wanted and near
        else:
            false += bool(said)
            values = []
        others = {e for axis in found for e in found[axis][1]}
        cells = [f"{v['value']:.4f} +- {v['standard_error']:.4f}" for v in values] or ["", ""]
        print(f"| {i} | {machine['shared']:.4f} | {', '.join(sorted(said | others)) or 'nothing'} | "
              f"{' | '.join(cells)} |", flush=True)
    print(f"\nThe coupling is named, on both axes and nowhere else, and within four standard errors in {right} "
          f"of {coupled} machines; a coupling is named in {false} of {alone} without one.")


if __name__ == "__main__":
    main()
