#!/usr/bin/python3
"""first_contact.py [BUILD [SEED]]: how far a newcomer gets. Forty recordings, as tools of drives and loggers
write them (layouts.py), of machines that are simulated without the project's own simulator (machines.py):
from `fit-params --init` to the fit without an edit, or with one answer where the recording cannot tell.
A case is `within` when every parameter is within four of its standard errors of the truth, and those
are below a quarter of it; `honest` when the tool says that it cannot tell; `wrong` otherwise. Where the
tool asks for an option, it gets the answer. Seconds are those of --init and the fit together."""
import gzip
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

import layouts
from machines import Axis, Machine, levels, move, place_loop, simulate, speed_loop, waves

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "release").resolve()
SECONDS = 6
SEED = int(sys.argv[2]) if len(sys.argv) > 2 else 1
GOAL = 10.0  # s


def machines():
    r = np.random.default_rng(SEED)
    current = lambda: levels(r, 5.0, SECONDS)
    speed = lambda: levels(r, 0.4, SECONDS)
    rest = current()
    rest[1000:5200] = 0.0
    hold = levels(r, 5.0, SECONDS, mean=60.0 / 6.5)
    return {
        "plain SI units": (layouts.plain, Machine(demand=current())),
        "encoder counts": (layouts.counts, Machine(demand=current())),
        "degrees": (layouts.degrees, Machine(demand=current())),
        "mm/min": (layouts.per_minute, Machine(demand=current())),
        "German words, decimal commas": (layouts.german, Machine(demand=current())),
        "a weight": (layouts.plain, Machine(weight=60.0, demand=hold)),
        "a PI drive": (layouts.pi_drive, Machine(control="velocity", demand=speed())),
        "wrong sign, two files": (layouts.wrong_sign, Machine(demand=current())),
        "noise on the input": (layouts.noisy_input, Machine(demand=current())),
        "logged late by one sample": (layouts.late, Machine(demand=current())),
        "at rest for 70 % of the time": (layouts.plain, Machine(demand=rest)),
        "lines above the names": (layouts.preamble, Machine(demand=current())),
        "no header": (layouts.headerless, Machine(demand=current())),
        "force and motion in two files": (layouts.two_files, Machine(demand=current())),
        "TwinCAT Scope": (layouts.twincat, Machine(demand=current())),
        "LabVIEW": (layouts.labview, Machine(demand=current())),
        "MR Configurator": (layouts.configurator, Machine(demand=current())),
        "CiA 402 objects": (layouts.cia_402, Machine(demand=current())),
        "dates, texts, repeated names": (layouts.messy, Machine(demand=current())),
        "several rates, gzip": (layouts.several_rates, Machine(demand=current())),
    }


def axes():
    """Layouts and axes of the second twenty."""
    r = np.random.default_rng(SEED + 200)
    ramp = lambda volts, slope: math.copysign(slope, volts) * np.arange(0.0, abs(volts) / slope, 0.02)
    lift = lambda demand, start=0.0: Axis(0.12, 3.2, 0.35, demand, constant=-0.2, start=start, turns=False,
                                          sample=0.02)  # fmt: skip
    mass = lambda demand, **others: Axis(12.0, 30.0, 8.0, demand, gain=6.5, turns=False, **others)
    slope, step = r.uniform(0.8, 1.2), r.uniform(6.0, 8.0)
    steps = r.uniform(4.0, 6.0) * np.repeat([1.0, 0.0, -1.0, 0.0], [800, 700, 800, 700])
    peaks = 6.0 * r.uniform(0.5, 1.0, 11) * (-1.0) ** np.arange(11)
    ramps = np.interp(np.arange(6000), np.linspace(0, 6000, 12), np.append(0.0, peaks))
    to_stop = np.append(waves(r, 0.06, 4.5, 1.2), np.interp(np.arange(1500), [0, 700], [0.0, 0.4]))
    return {
        "mostly friction, robot's names": (layouts.joint_states, Axis(
            0.15, 6.0, 22.0, waves(r, 0.4, 8, 1.2), place_loop(900.0, 12.0, 60.0))),
        "Coulomb friction alone, JSON": (layouts.json_rows, Axis(
            5.0, 0.0, 12.0, levels(r, 0.4, 6), speed_loop(120.0, 500.0, 60.0), turns=False)),
        "10 Hz, a slow axis": (layouts.slow_log, Axis(
            2000.0, 1500.0, 300.0, waves(r, 1500.0, 120, 0.15), turns=False)),
        "two motors in one file": (layouts.two_motors, mass(levels(r, 5.0, 6)), Axis(
            9.0, 25.0, 6.0, levels(r, 5.0, 6), gain=6.5, turns=False)),
        "a reference beside the position": (layouts.beside_reference, Axis(
            1.2, 3.0, 4.0, waves(r, 0.5, 6, 1.0), place_loop(400.0, 30.0, 60.0))),
        "FRC elevator, four tests": (layouts.elevator, lift(ramp(3.0, slope)), lift(ramp(-3.0, slope), 1.5),
                                     lift(np.full(38, step)), lift(np.full(38, -step), 1.5)),
        "FRC flywheel, a late velocity": (layouts.flywheel, Axis(
            0.006, 0.02, 0.15, np.repeat(r.uniform(-10, 10, 8), 1500))),
        "FRC arm": (layouts.arm, Axis(
            0.08, 1.5, 0.2, 0.8 + waves(r, 0.6, 10, 0.4, 0.02), place_loop(25.0, 0.5, 12.0), cosine=0.6,
            start=0.5, sample=0.02)),
        "steps from the first sample": (layouts.plain, mass(steps)),
        "ramps, frames of four": (layouts.frames, mass(ramps)),
        "turns and rpm": (layouts.spindle, Axis(0.004, 0.002, 0.05, levels(r, 5.0, 6), gain=0.11)),
        "duty and battery": (layouts.duty, Axis(0.05, 0.8, 0.5, levels(r, 9.0, 6))),
        "PWM to 255, millis": (layouts.hobby, Axis(
            0.05, 0.15, 0.9, 12 / 255 * np.repeat(r.integers(0, 256, 12), 60), sample=0.01)),
        "a pendulum without times": (layouts.no_times, Axis(
            0.05, 0.05, 0.1, waves(r, 1.2, 8, 0.8), sine=1.5)),
        "stamps that jitter": (layouts.jittery, mass(levels(r, 5.0, 8)[::5], sample=5e-3)),
        "a list of changes": (layouts.changes, Axis(
            0.25, 2.3, 0.3, np.repeat(r.uniform(-8, 8, 20), 25), turns=False, sample=0.02)),
        "filtered torque": (layouts.filtered_torque, Axis(1.0, 4.0, 5.0, levels(r, 25.0, 6))),
        "against a hard stop": (layouts.plain, mass(
            to_stop, control=place_loop(600.0, 20.0, 10.0), stop=0.2)),
        "a counter that overflows, rows twice": (layouts.overflowing, Axis(
            0.004, 0.002, 0.05, levels(r, 5.0, 6), gain=0.11)),
        "encoders of motor and joint": (layouts.both_encoders, Axis(
            0.5, 0.8, 1.5, waves(r, 0.6, 6, 1.2, 1e-4), stiffness=4000.0, sample=1e-4)),
    }  # fmt: skip


def fit(files, answers, ask, folder):
    """The result, what --init said, what it asked for, and the seconds of --init and fit."""
    for name, contents in files.items():
        data = contents.encode()
        (folder / name).write_bytes(gzip.compress(data) if name.endswith(".gz") else data)

    def run(*arguments):
        return subprocess.run([BUILD / "apps" / "fit-params", *arguments], cwd=folder, capture_output=True,
                              text=True)  # fmt: skip

    begin = time.perf_counter()
    made, asked = run("--init", *files, *answers), []
    if made.returncode != 0 and ask and ask[0] in made.stderr:
        begin, asked = time.perf_counter(), ask[1]
        made = run("--init", *files, *answers, *asked)
    done = run("job.yaml", "--json") if made.returncode == 0 else made
    seconds = time.perf_counter() - begin
    if made.returncode != 0 or done.returncode not in (0, 3):
        return None, done.stderr, asked, seconds
    return json.loads(done.stdout), made.stderr, asked, seconds


def judge(result, said, truth):
    """Verdict, and the largest error in standard errors. What is zero has an error below a quarter of the
    friction, or is at its bound, or may be missing."""
    if result is None:
        return "refused: " + said.strip().splitlines()[-1], ""
    friction = next(value for name, value in truth.items() if name.startswith("coulomb_friction"))
    worst, vague = ("", 0.0), []
    found = {p["name"]: p for p in result["parameters"]}
    for name, true in truth.items():
        p = found.get(name)
        if p is None or (true == 0.0 and p["value"] == 0.0):
            vague += [f"no {name}"] if true else []
            continue
        error = p["standard_error"]
        if error is None or error > 0.25 * (abs(true) or friction):
            vague.append(name)
            continue
        away = abs(p["value"] - true) / error
        if away >= worst[1]:
            worst = (name, away)
    grade = result["grade"]
    shown = f"{worst[1]:.1f} ({worst[0]})"
    if not result["usable"]:
        return f"honest: {grade}", shown
    if worst[1] > 4.0:
        return f"wrong ({grade})", shown
    if vague:
        return f"vague: {', '.join(vague)} ({grade})", shown
    return f"within ({grade})", shown


def cases():
    """Name, truth, and what the layout made of the motions."""
    layouts.RNG = np.random.default_rng(SEED + 100)
    carriages = machines()
    for (name, (layout, machine)), motion in zip(
        carriages.items(), simulate([machine for _, machine in carriages.values()])):  # fmt: skip
        yield name, machine.truth, layout(motion)
    for name, (layout, *of) in axes().items():
        yield name, of[0].truth, layout(*map(move, of))


def main():
    good = count = slow = 0
    print("`bench/first_contact.py`: from --init to the fit.\n")
    print("| recording | answers | result | largest error, standard errors | s |\n|---|---|---|---|---|")
    for name, truth, (files, answers, *ask) in cases():
        with tempfile.TemporaryDirectory() as folder:
            result, said, asked, seconds = fit(files, answers, ask[0] if ask else None, pathlib.Path(folder))
        verdict, worst = judge(result, said, truth)
        count += 1
        good += verdict.startswith(("within", "honest"))
        slow += seconds > GOAL
        shown = [a for a in answers if not a.startswith("--")] + [f"asked: {a}" for a in asked[1:]]
        print(f"| {name} | {' '.join(shown) or 'none'} | {verdict} | {worst} | {seconds:.1f} |", flush=True)
    print(f"\n{good} of {count} reach the truth or say honestly that they do not.")
    print(f"{slow} of {count} take more than {GOAL:g} s.")
    return 0 if good == count else 1


if __name__ == "__main__":
    sys.exit(main())
