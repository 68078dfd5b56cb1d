#!/usr/bin/python3
"""channels.py [BUILD [SEEDS]]: does `--close-loop` name the recorded channel that acts on an axis?

Axes of about 12 kg with four channels beside them: a temperature, the position and the acceleration of a
neighbour, and the voltage of the supply. One of them acts, or none. Simulated here and not by the project:
Runge-Kutta steps of 50 us, dry friction as a steep tanh, laws that are not the catalogue's (grease thins
out exponentially, a slope is a sine, drag of 1.8th power besides), noise on every channel. A case is right
when that channel, and in the right place, is the only one that is accepted; "besides" tells that another
effect was, too."""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from scipy import signal

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "release").resolve()
SEEDS = int(sys.argv[2]) if len(sys.argv) > 2 else 5
RATE, STEPS, SECONDS = 250, 40, 8.0
SAMPLES = int(SECONDS * RATE)

# What acts, and what may be said of it.
KINDS = {
    "seal": ("temperature", {"channel_friction"}),
    "grease": ("temperature", {"channel_damping"}),
    "slope": ("neighbour", {"channel_force"}),
    "reaction": ("neighbour_acceleration", {"channel_force"}),
    "inertia": ("neighbour", {"channel_mass"}),
    "supply": ("supply", {"channel_gain"}),
    "nothing": (None, set()),
}
AXIS = """name: axis with channels
drive: force_source
transmission: rigid
parameters: {K_f: 1 N/V, M: 20 kg, B_a: 60 N s/m}
effects:
  coulomb_friction: {F_c: 5 N}
  constant_force: {F_0: 0 N}
"""
RECORDING = """- file: {name}.csv
  role: {role}
  time: {{column: t, unit: s}}
  signals:
    drive_force: {{column: force, unit: N}}
    position: {{column: position, unit: mm}}
    velocity: {{column: velocity, unit: mm/s}}
  channels:
    temperature: {{column: temperature, unit: degC}}
    neighbour: {{column: neighbour, unit: mm}}
    neighbour_acceleration: {{column: acceleration, unit: m/s^2}}
    supply: {{column: supply, unit: V}}
"""
FREE = """free:
  M: {}
  B_a: {}
  coulomb_friction.F_c: {}
  constant_force.F_0: {}
"""


def wander(rng, corner, size):
    noise = rng.standard_normal(SAMPLES + 8 * RATE)
    slow = signal.sosfilt(signal.butter(2, corner, fs=RATE, output="sos"), noise)[8 * RATE :]
    return size * slow / np.std(slow)


def sines(rng, reach):
    """Position, velocity and acceleration of a smooth motion that begins at rest in the middle."""
    t = np.arange(SAMPLES) / RATE
    f, phase = rng.uniform(0.1, 0.9, 4), rng.uniform(0, 2 * np.pi, 4)
    a = rng.uniform(0.5, 1.0, 4) / f
    a *= reach / a.sum()
    w = 2 * np.pi * f[:, None]
    u = np.clip(t / 0.6, 0.0, 1.0)
    place = (a @ np.sin(w * t + phase[:, None])) * u**3 * (10.0 - 15.0 * u + 6.0 * u**2)
    speed = np.gradient(place, 1.0 / RATE)
    return place, speed, np.gradient(speed, 1.0 / RATE)


def recorded(rng):
    """The channels of one recording, and what the axis shall do."""
    t = np.arange(SAMPLES) / RATE
    begin, rise, tau = rng.uniform(22, 32), rng.uniform(8, 16), rng.uniform(4, 12)
    temperature = begin + rise * (1 - np.exp(-t / tau)) + wander(rng, 0.3, 0.5)
    place, _, acceleration = sines(rng, 0.4)
    supply = 48.0 - np.abs(wander(rng, 0.25, 2.0)) + wander(rng, 2.0, 0.3)
    return {"demand": sines(rng, 0.25), "temperature": temperature, "neighbour": place,
            "neighbour_acceleration": acceleration, "supply": supply}


def simulate(kinds, drawn, runs):
    """All cases at once. `runs` are what recorded() says; per case a dictionary of columns."""
    is_kind = lambda name: np.array([k == name for k in kinds]) * 1.0
    of = lambda name: np.array([d[name] for d in drawn])
    course = {n: np.stack([r[n] for r in runs], -1) for n in runs[0] if n != "demand"}
    demand = np.stack([r["demand"] for r in runs], -1)
    mass, viscous, coulomb, size = of("mass"), of("viscous"), of("coulomb"), of("size")
    h = 1.0 / (RATE * STEPS)
    slope_of = {n: np.vstack([np.diff(c, axis=0), np.zeros(c.shape[1])]) for n, c in course.items()}
    seal, grease, slope = is_kind("seal"), is_kind("grease"), is_kind("slope")
    reaction, inertia, supply = is_kind("reaction"), is_kind("inertia"), is_kind("supply")

    def rate(k, part, y, v, force):
        at = {n: course[n][k] + part * slope_of[n][k] for n in course}
        thin = np.exp(-(at["temperature"] - 30.0) / 40.0)
        gain = 1.0 + supply * (at["supply"] / 46.0 - 1.0) * (0.5 + size)
        dry = coulomb * (1.0 + seal * size * (thin - 1.0))
        drag = viscous * (1.0 + grease * 1.5 * size * (thin - 1.0))
        push = slope * 10.0 * size * np.sin(1.5 * at["neighbour"])
        push = push - reaction * 0.25 * size * mass * at["neighbour_acceleration"]
        more = inertia * size * mass * at["neighbour"]
        more_rate = inertia * size * mass * slope_of["neighbour"][k] * RATE
        friction = dry * np.tanh(v / 2e-4) + drag * v + 0.3 * np.abs(v) ** 1.8 * np.sign(v)
        return (gain * force - friction + push - more_rate * v) / (mass + more)

    y, v = demand[0, 0].copy(), demand[1, 0].copy()
    log = np.zeros((3, SAMPLES, len(kinds)))
    force = np.zeros(len(kinds))
    for k in range(SAMPLES):
        w = 20.0
        after = np.clip(mass * (demand[2, k] + w * w * (demand[0, k] - y) + 2 * w * (demand[1, k] - v)), -400, 400)
        log[:, k] = force, y, v
        for step in range(STEPS):
            p, m, q = step / STEPS, (step + 0.5) / STEPS, (step + 1) / STEPS
            f = lambda part: force + part * (after - force)
            a1 = rate(k, p, y, v, f(p))
            a2 = rate(k, m, y + 0.5 * h * v, v + 0.5 * h * a1, f(m))
            v2 = v + 0.5 * h * a1
            a3 = rate(k, m, y + 0.5 * h * v2, v + 0.5 * h * a2, f(m))
            v3 = v + 0.5 * h * a2
            a4 = rate(k, q, y + h * v3, v + h * a3, f(q))
            y = y + h / 6 * (v + 2 * (v2 + v3) + v + h * a3)
            v = v + h / 6 * (a1 + 2 * (a2 + a3) + a4)
        force = after
    return log, course


def main():
    cases = [(kind, seed) for kind in KINDS for seed in range(SEEDS if kind != "nothing" else 4 * SEEDS)]
    drawn, runs = [], []
    for kind, seed in cases:
        rng = np.random.default_rng([sorted(KINDS).index(kind), seed])
        drawn.append({"mass": rng.uniform(8, 16), "viscous": rng.uniform(20, 60),
                      "coulomb": rng.uniform(6, 14), "size": rng.uniform(0.2, 0.6)})
        runs.append([recorded(rng), recorded(rng)])
    logs = [simulate([c[0] for c in cases], drawn, [r[i] for r in runs]) for i in range(2)]
    print(f"`bench/channels.py` with {SEEDS} seeds: the channel that acts, named by --close-loop\n")
    print("| case | chi-square before | accepted | verdict | s |\n|---|---|---|---|---|")
    right = besides = wrong = false = clean = 0
    for c, (kind, seed) in enumerate(cases):
        noise = np.random.default_rng([99, c])
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            for name, (log, course) in zip(("a", "b"), logs):
                columns = {"t": np.arange(SAMPLES) / RATE, "force": log[0, :, c],
                           "position": 1e3 * (log[1, :, c] + 3e-4 * noise.standard_normal(SAMPLES)),
                           "velocity": 1e3 * (log[2, :, c] + 4e-3 * noise.standard_normal(SAMPLES))}
                for channel, size, factor in (("temperature", 0.2, 1), ("neighbour", 2e-5, 1e3),
                                              ("neighbour_acceleration", 0.05, 1), ("supply", 0.1, 1)):
                    values = course[channel][:, c] + size * noise.standard_normal(SAMPLES)
                    columns[channel.split("_")[-1]] = factor * values
                table = np.column_stack(list(columns.values()))
                np.savetxt(folder / f"{name}.csv", table, "%.9g", ",", header=",".join(columns), comments="")
            (folder / "axis.yaml").write_text(AXIS)
            (folder / "job.yaml").write_text("axis: axis.yaml\nrecordings:\n" + "".join(
                RECORDING.format(name=n, role=r) for n, r in (("a", "fit"), ("b", "validate"))) + FREE)
            done = subprocess.run([BUILD / "apps" / "fit-params", folder / "job.yaml", "--close-loop", "--json", "--time-limit", "120"],
                                  capture_output=True, text=True)
            try:
                result = json.loads(done.stdout)
            except json.JSONDecodeError:
                sys.exit(f"{kind} {seed}: {done.stderr}")
        accepted = [e["name"] for e in result.get("effects", []) if e["decision"] == "accepted"]
        channel, places = KINDS[kind]
        by_channel = [a for a in accepted if a.startswith("channel_")]
        if channel is None:
            clean += 1
            false += bool(by_channel)
            verdict = "false" if by_channel else "right"
        else:
            expected = {f"{place}.{channel}" for place in places}
            verdict = "missed" if not by_channel else "right" if set(by_channel) <= expected else "wrong"
            right += verdict == "right"
            wrong += verdict == "wrong"
            if verdict == "right" and len(accepted) > len(by_channel):
                verdict, besides = "right, besides", besides + 1
        before = result.get("before", {}).get("reduced_chi_square", float("nan"))
        print(f"| {kind} {seed} | {before:.3g} | {' '.join(accepted) or '-'} | {verdict} "
              f"| {result['wall_time_s']:.3g} |", flush=True)
    print(f"\n{right} of {len(cases) - clean} right ({besides} with another effect besides), {wrong} wrong; "
          f"a channel accepted in {false} of {clean} cases in which none acts.")


if __name__ == "__main__":
    main()
