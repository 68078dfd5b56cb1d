#!/usr/bin/python3
"""honesty.py [BUILD] [--only NAME ...] [--jobs N] [--list]: how honest the grade of fit-params is.

Every situation makes recordings, axis.yaml and job.yaml as a user would have them, right or wrong
in a known way, and compares the grade of the fit with the one that it deserves. The machines are
simulated here, by fixed steps, not by the program that is measured. A situation passes if

- the grade given is not better than the one deserved, and
- no effect is accepted that is not true of the machine or its instruments.

A grade worse than deserved is `strict`: allowed, but shown. `error` is the largest rms error of the
free-running simulation over the signals, in per cent of the standard deviation of the measured one.
`worst parameter` is the determined one whose estimate is farthest from the truth, in standard
errors. It is shown where the truth is known, and does not decide. By the deserved grade, a model
that lacks something is usable if that error is well below 50 %, and wrong if it is well above."""
import argparse
import collections
import concurrent.futures
import dataclasses
import json
import math
import os
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent


# The machines: fixed steps, no events.


@dataclasses.dataclass
class Slide:
    """A mass that a force K_f U moves, with viscous and dry friction. `force`, `dry`, `mass` and
    `supply` are whatever else acts: functions of time, position, velocity and, last, the force."""

    M: float = 12.0
    B: float = 40.0
    F_c: float = 9.0
    F_0: float = 3.0
    K_f: float = 20.0
    F_max: float = 250.0
    force: object = None  # N, of (t, y, v)
    dry: object = None  # N, of (t, y, v, drive force)
    mass: object = None  # kg, of t
    supply: object = None  # of t: part of the force that arrives

    def run(self, drive, seconds=4.0, rate=500, steps=20, y=0.0, v=0.0):
        log = {name: [] for name in ("time", "command", "position", "velocity", "acceleration")}
        h = 1.0 / (rate * steps)
        a = 0.0
        for k in range(round(seconds * rate) + 1):
            t = k / rate
            u = drive(t, y, v)
            for name, value in zip(log, (t, u, y, v, a)):
                log[name].append(value)
            push = self.K_f * u
            for s in range(steps):
                ts = t + (s + 0.5) * h
                f = push * self.supply(ts) if self.supply else push
                ys, vs = y + 0.5 * h * v, v + 0.5 * h * a if v else 0.0  # half a step on
                level = self.F_c + (self.dry(ts, ys, vs, f) if self.dry else 0.0)
                M = self.mass(ts) if self.mass else self.M
                total = f + self.F_0 + (self.force(ts, ys, vs) if self.force else 0.0)
                left = h
                while left > 0.0:
                    b = 0.5 * left * self.B / M
                    slid = (v * (1.0 - b) + left * total / M) / (1.0 + b)
                    stop = left * level / M / (1.0 + b)
                    step = left
                    if v == 0.0:
                        new = math.copysign(max(abs(slid) - stop, 0.0), slid)
                    else:
                        new = slid - math.copysign(stop, v)
                        if v * new < 0.0:  # it stops within the step
                            new, step = 0.0, left * v / (v - new)
                    a = (new - v) / step
                    y += 0.5 * step * (v + new)
                    v = new
                    left -= step
        return log


ROBOT = {"R": 0.56, "L": 2.35e-3, "K_e": 0.289, "K_m": 0.289, "J_m": 8.47e-4, "B_m": 7.33e-4,
         "K_t": 0.0668, "r_g": 5.73e-3, "H": 1e-5, "M": 146.0, "T_z": 7.05e-3, "T_p": 0.04,
         "T_r": 1.59e-4, "K_1": 1014.2, "K_2": 870.0, "K_i": 3.0, "V_s": 95.0, "V_L": 2.7,
         "B_a": 200.0, "b_g": 1500.0, "k_g": 5e6, "F_s": 30.0, "w": 2e-3, "K_v": 1000.0}  # fmt: skip


def robot(drive, seconds=1.2, rate=1000, steps=200, F_c=0.0, **other):
    """The paper's axis, docs/model.md, with Coulomb friction F_c."""
    p = {**ROBOT, **other}
    log = {name: [] for name in ("time", "command", "position", "velocity", "acceleration",
                                 "tachometer", "motor_current")}
    h = 1.0 / (rate * steps)
    J, M, r, H, k_g, b_g = (p[n] for n in ("J_m", "M", "r_g", "H", "k_g", "b_g"))
    K_m, K_e, K_v, L, V_s, V_L = (p[n] for n in ("K_m", "K_e", "K_v", "L", "V_s", "V_L"))
    T_z, F_s, w_s, back = p["T_z"], p["F_s"], p["w"], p["K_2"] * p["K_t"]
    c5 = h / (p["T_p"] * p["T_r"])
    d5 = 1.0 + c5 * (p["T_p"] + p["T_r"])
    d6, c6 = 1.0 + h / L * (p["R"] + K_v / p["K_i"]), K_v / p["K_i"]
    d6_limited, dw, dv = 1.0 + h / L * p["R"], 1.0 + h * p["B_m"] / J, 1.0 + h * p["B_a"] / M
    y = v = th = w = y4 = y5 = i = a = 0.0
    for k in range(round(seconds * rate) + 1):
        u = drive(k / rate)
        reading = (k / rate, u, r * th, v, a, p["K_t"] * w, i)
        for name, value in zip(log, reading):
            log[name].append(value)
        set_point = p["K_1"] * u
        for _ in range(steps):
            y5 = (y5 + c5 * (set_point - back * w - y4)) / d5
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
            stop = h / M * (F_c + F_s if abs(v) < w_s else F_c) / dv
            new = math.copysign(max(abs(slid) - stop, 0.0), slid)
            a = (new - v) / h
            v = new
            y += h * v
            th += h * w
    return log


GRADES = ("explained", "usable", "model_wrong", "nothing_determined", "not_converged", "refused")
EXPLAINED, USABLE, MODEL_WRONG, NOTHING_DETERMINED, NOT_CONVERGED, REFUSED = GRADES


# Motions.


def path(rng, seconds, stroke=0.25, least=0.25, most=0.6, rest=0.2):
    """Position, velocity and acceleration over time: moves to random places, with rests."""
    moves, t, place = [], 0.05, 0.0
    while t < seconds:
        lasts = rng.uniform(least, most)
        to = rng.uniform(-stroke, stroke)
        if abs(to - place) < 0.3 * stroke:
            continue
        moves.append((t, lasts, place, to))
        place = to
        t += lasts + (rng.uniform(0.05, 0.15) if rng.random() < rest else 0.0)

    def reference(t):
        at = 0.0
        for begin, lasts, a, b in moves:
            if t < begin:
                break
            if t < begin + lasts:
                w = math.pi / lasts
                q = w * (t - begin)
                d = 0.5 * (b - a)
                return a + d * (1 - math.cos(q)), d * w * math.sin(q), d * w * w * math.cos(q)
            at = b
        return at, 0.0, 0.0

    return reference


def follow(machine, reference, bandwidth=30.0):
    """A drive that controls the position of a slide, and whose command is a force."""

    def drive(t, y, v):
        r, dr, ddr = reference(t)
        f = ddr + bandwidth**2 * (r - y) + 2.0 * bandwidth * (dr - v)
        f = min(max(machine.M * f - machine.F_0, -machine.F_max), machine.F_max)
        return round(f / machine.K_f, 6)

    return drive


def levels(rng, seconds=1.2, most=8.0):
    """Set-velocity voltages over time: levels of random size and sign, and zero at the end."""
    steps, t, sign = [], 0.0, rng.choice((-1, 1))
    while t < seconds - 0.15:
        steps.append((t, sign * round(rng.uniform(0.3, 1.0) * most, 2)))
        t += round(rng.uniform(0.12, 0.25), 3)
        sign = -sign
    steps.append((t, 0.0))
    return lambda now: next(u for begin, u in reversed(steps) if now >= begin - 1e-9)


# What the user writes.

UNITS = {"command": "V", "drive_force": "N", "position": "m", "velocity": "m/s",
         "acceleration": "m/s^2", "tachometer": "V", "motor_current": "A"}  # fmt: skip
ROBOT_UNITS = {"R": "ohm", "L": "H", "K_e": "V s/rad", "K_m": "N m/A", "J_m": "kg m^2",
               "B_m": "N m s/rad", "K_t": "V s/rad", "r_g": "m", "H": "m", "M": "kg", "T_z": "s",
               "T_p": "s", "T_r": "s", "K_1": "", "K_2": "", "K_i": "A/V", "V_s": "V", "V_L": "V",
               "B_a": "N s/m", "b_g": "N s/m", "k_g": "N/m", "F_s": "N", "w": "m/s",
               "K_v": ""}  # fmt: skip


def with_unit(value, unit):
    return f"{value:.9g} {unit}" if unit else float(f"{value:.9g}")


class Job:
    """Collects axis.yaml, job.yaml and the recordings of a situation, and the truth."""

    def __init__(self, name):
        self.rng = random.Random(name)
        self.axis, self.free, self.fit, self.truth = {}, {}, {}, {}
        self.files, self.recordings = {}, []

    def measure(self, log, **noise):
        """What instruments with white noise of these standard deviations record of a run."""
        record = {"time": list(log["time"]), "command": list(log["command"])}
        for signal, sigma in noise.items():
            record[signal] = [x + self.rng.gauss(0.0, sigma) for x in log[signal]]
        return record

    def add(self, record, role="fit", name=None, file=None, sigma=None, **options):
        name = name or f"{role}{len(self.recordings) + 1}"
        file = file or f"{name}.csv"
        self.files.setdefault(file, record)
        signals = {s: {"column": s, "unit": UNITS[s]} for s in record if s != "time"}
        if "drive_force" in signals:  # of these machines it holds, as a command does
            signals["drive_force"]["hold"] = "zero_order"
        for signal, value in (sigma or {}).items():
            signals[signal]["sigma"] = with_unit(value, UNITS[signal])
        self.recordings.append({"name": name, "file": file, "role": role,
                                "time": {"column": "time", "unit": "s"}, "signals": signals,
                                **options})  # fmt: skip

    def runs(self, machine, change=None, seconds=4.0, rate=500, validate=True, motion=None,
             sigma=None, **noise):  # fmt: skip
        """A run to fit and another to validate; `change` is what happens to the recordings."""
        for role in ("fit", "validate") if validate else ("fit",):
            reference = path(self.rng, seconds, **(motion or {}))
            log = machine.run(follow(machine, reference), seconds, rate, max(4, 10000 // rate))
            record = self.measure(log, **noise)
            if change:
                change(record, log)
            self.add(record, role, sigma=sigma)

    def declare(self, machine, K_f=None, free="M B_a F_c F_0"):
        """The axis of a slide, with poor initial values, and all of `free` to be fitted."""
        K_f = K_f or machine.K_f
        scale = K_f / machine.K_f
        self.axis.update(
            drive="force_source",
            transmission="rigid",
            parameters={"K_f": with_unit(K_f, "N/V"), "M": with_unit(0.5 * machine.M, "kg"),
                        "B_a": with_unit(2.0 * machine.B, "N s/m")})  # fmt: skip
        most = max(500.0, 10.0 * machine.F_max)
        for name in free.split():
            if name in ("M", "B_a"):
                self.free[name] = {}
                self.truth[name] = scale * (machine.M if name == "M" else machine.B)
                continue
            effect = {"F_c": "coulomb_friction", "F_0": "constant_force"}[name]
            start = "1 N" if name == "F_c" else "0 N"
            least = "0 N" if name == "F_c" else with_unit(-most, "N")
            self.axis.setdefault("effects", {})[effect] = {name: start}
            self.free[f"{effect}.{name}"] = {"bounds": [least, with_unit(most, "N")]}
            self.truth[f"{effect}.{name}"] = scale * getattr(machine, name)

    def robot_runs(self, change=None, seconds=1.2, most=8.0, validate=True, true=None, **noise):
        for role in ("fit", "validate") if validate else ("fit",):
            log = robot(levels(self.rng, seconds, most), seconds, **(true or {}))
            record = self.measure(log, **noise)
            if change:
                change(record, log)
            self.add(record, role)

    def declare_robot(self, free="V_L B_a b_g k_g T_p", true=None, **declared):
        """The axis of the paper, with poor initial values of what is free."""
        values = {**ROBOT, **declared}
        self.truth = {name: {**ROBOT, **(true or {})}[name] for name in free.split()}
        for name in free.split():
            poor = {"V_L": 2.0, "B_a": 0.4, "b_g": 2.0, "k_g": 0.4, "T_p": 2.0}.get(name, 1.3)
            self.free[name] = {"initial": with_unit(poor * values[name], ROBOT_UNITS[name])}
        self.axis.update(
            drive="velocity_loop", transmission="backlash",
            parameters={n: with_unit(x, ROBOT_UNITS[n]) for n, x in values.items()})  # fmt: skip

    def write(self, folder):
        for file, record in self.files.items():
            rows = [",".join(record)]
            rows += [",".join(f"{x:.9g}" for x in row) for row in zip(*record.values())]
            pathlib.Path(folder, file).write_text("\n".join(rows) + "\n")
        job = {"axis": "axis.yaml", "recordings": self.recordings, "free": self.free}
        if self.fit:
            job["fit"] = self.fit
        pathlib.Path(folder, "axis.yaml").write_text(json.dumps(self.axis, indent=1) + "\n")
        pathlib.Path(folder, "job.yaml").write_text(json.dumps(job, indent=1) + "\n")


# The situations.


@dataclasses.dataclass
class Situation:
    deserved: str
    reason: str  # why it deserves that grade
    effects: frozenset  # that are true: accepting them is right
    loop: bool  # with --close-loop
    make: object


SITUATIONS = {}


def situation(deserved, reason, *effects, loop=True):
    def enter(make):
        SITUATIONS[make.__name__] = Situation(deserved, reason, frozenset(effects), loop, make)
        return make

    return enter


SLIDE = Slide()
MOTOR = Slide(M=2.5, B=12.0, F_c=6.0, F_0=0.0, K_f=30.0, F_max=120.0)
GANTRY = Slide(M=180.0, B=500.0, F_c=90.0, F_0=-20.0, K_f=110.0, F_max=2500.0)
RUBBING = Slide(M=8.0, B=15.0, F_c=60.0, F_0=0.0, K_f=25.0)  # most of its force overcomes friction
ROBOT_NOISE = {"velocity": 0.002, "acceleration": 0.05}
LATER = ("velocity.delay", "dead_time")  # one signal cannot tell them apart


def shift(values, samples):
    """Later by so many samples; earlier if negative."""
    last = len(values) - 1
    return [values[min(max(k - samples, 0), last)] for k in range(last + 1)]


def at(values, index):
    """Between the samples, linearly."""
    k = min(max(int(index), 0), len(values) - 2)
    return values[k] + (index - k) * (values[k + 1] - values[k])


# The declared axis is the true one.


@situation(EXPLAINED, "the declared axis is the true one")
def clean_velocity(job):
    job.runs(SLIDE, velocity=0.002)
    job.declare(SLIDE)


@situation(EXPLAINED, "the declared axis is the true one")
def clean_position(job):
    job.runs(GANTRY, position=20e-6)
    job.declare(GANTRY)


@situation(EXPLAINED, "the declared axis is the true one", loop=False)
def clean_both(job):
    job.runs(MOTOR, position=5e-6, velocity=0.005)
    job.declare(MOTOR)


@situation(EXPLAINED, "the true axis; an encoder that rounds down, which is declared")
def clean_encoder(job):
    def quantise(record, log):
        record["position"] = [math.floor(y / 5e-6) * 5e-6 for y in log["position"]]

    job.runs(SLIDE, change=quantise, position=0.0)
    job.declare(SLIDE)
    job.axis["instruments"] = {"position": {"bias": "-2.5 um"}}


@situation(EXPLAINED, "the declared axis is the true one")
def clean_noisy(job):
    job.runs(SLIDE, velocity=0.05)
    job.declare(SLIDE)


@situation(EXPLAINED, "the declared axis is the true one; the force in N is the input")
def clean_drive_force(job):
    def in_newtons(record, log):
        record["drive_force"] = [MOTOR.K_f * u for u in record.pop("command")]

    job.runs(MOTOR, change=in_newtons, position=5e-6)
    job.declare(MOTOR)


@situation(EXPLAINED, "the true axis in every recording, with different noise", loop=False)
def clean_five_recordings(job):
    for role, noise in (("fit", 1), ("fit", 5), ("fit", 20), ("validate", 2), ("validate", 50)):
        log = SLIDE.run(follow(SLIDE, path(job.rng, 2.0)), 2.0)
        job.add(job.measure(log, velocity=0.001 * noise), role)
    job.declare(SLIDE)


@situation(EXPLAINED, "the weight is declared as a constant force")
def clean_vertical(job):
    lift = dataclasses.replace(SLIDE, F_0=-12.0 * 9.81, F_max=350.0)
    job.runs(lift, velocity=0.002)
    job.declare(lift)
    job.axis["effects"]["constant_force"]["F_0"] = "-100 N"


@situation(EXPLAINED, "the times are uneven, and recorded as they are")
def clean_uneven_times(job):
    def unevenly(record, log):
        keep = [k for k in range(len(log["time"])) if k == 0 or job.rng.random() < 0.7]
        held = [k for k in range(len(log["time"])) if k not in set(keep)]
        assert held
        for name in record:
            record[name] = [record[name][k] for k in keep]

    slow = dataclasses.replace(SLIDE, F_max=200.0)
    for role in ("fit", "validate"):
        drive, held = follow(slow, path(job.rng, 4.0)), [0.0, 0]

        def sometimes(t, y, v, drive=drive, held=held):
            """A drive that looks at the axis at uneven times, at which it is also recorded."""
            if t >= held[0] - 1e-9:
                held[:] = t + job.rng.choice((0.001, 0.002, 0.002, 0.003, 0.004)), drive(t, y, v)
                looks.append(round(1000 * t))
            return held[1]

        looks = []
        log = slow.run(sometimes, 4.0, 1000, 10)
        record = job.measure(log, velocity=0.002)
        job.add({name: [values[k] for k in looks] for name, values in record.items()}, role,
                sigma={"velocity": 0.002})  # fmt: skip
    job.declare(slow)


@situation(EXPLAINED, "the friction with its peak at low speed is declared")
def stick_slip(job):
    slow = dataclasses.replace(SLIDE, F_0=0.0, dry=lambda t, y, v, f: 12 * math.exp(-abs(v) / 0.02))
    for role in ("fit", "validate"):
        speed, turn = job.rng.uniform(0.01, 0.015), job.rng.uniform(1.2, 1.8)

        def spring(t, y, v, speed=speed, turn=turn):  # pulled by a spring that moves slowly
            return 3000.0 * (speed * (t if t < turn else 2 * turn - t) - y) / slow.K_f

        log = slow.run(spring, 4.0)
        job.add(job.measure(log, position=2e-6), role, sigma={"position": 2e-6})
    job.declare(slow, free="M B_a F_c")
    job.axis["effects"]["stribeck_friction"] = {"F_st": "6 N", "v_st": "30 mm/s"}
    job.free["stribeck_friction.F_st"] = {"bounds": ["0 N", "100 N"]}
    job.free["stribeck_friction.v_st"] = {}
    job.truth.update({"stribeck_friction.F_st": 12.0, "stribeck_friction.v_st": 0.02})


@situation(EXPLAINED, "the declared axis is the true one")
def robot_clean(job):
    job.robot_runs(**ROBOT_NOISE)
    job.declare_robot()


@situation(EXPLAINED, "the declared axis is the true one")
def robot_tachometer(job):
    job.robot_runs(velocity=0.005, tachometer=0.01)
    job.declare_robot()


@situation(EXPLAINED, "the true axis, although the current is at its limit nearly all the time")
def robot_always_limited(job):
    for role, lasts in (("fit", 0.1), ("validate", 0.13)):
        log = robot(lambda t, lasts=lasts: -10.0 if int(t / lasts) % 2 else 10.0)
        job.add(job.measure(log, **ROBOT_NOISE), role,
                sigma={"velocity": 0.002, "acceleration": 0.05})  # fmt: skip
    job.declare_robot(free="V_L B_a")


# An effect is missing in the declared axis.


@situation(EXPLAINED, "the missing friction is in the catalogue", "coulomb_friction")
def coulomb_missing(job):
    job.runs(SLIDE, velocity=0.002)
    job.declare(SLIDE, free="M B_a F_0")
    job.truth["coulomb_friction.F_c"] = SLIDE.F_c


@situation(USABLE, "friction of a tenth of the force is missing", loop=False)
def coulomb_missing_no_loop(job):
    job.runs(SLIDE, velocity=0.002)
    job.declare(SLIDE, free="M B_a F_0")


@situation(MODEL_WRONG, "the friction that takes most of the force is missing", loop=False)
def coulomb_dominant_no_loop(job):
    job.runs(RUBBING, velocity=0.002, motion={"least": 0.7, "most": 1.3, "rest": 1.0})
    job.declare(RUBBING, free="M B_a")


@situation(EXPLAINED, "the missing friction is in the catalogue", "stribeck_friction")
def stribeck_missing(job):
    machine = dataclasses.replace(SLIDE, dry=lambda t, y, v, f: 8 * math.exp(-abs(v) / 0.1))
    job.runs(machine, velocity=0.002)
    job.declare(machine)
    job.truth.update({"stribeck_friction.F_st": 8.0, "stribeck_friction.v_st": 0.1})


@situation(EXPLAINED, "the missing friction is in the catalogue", "load_friction")
def load_friction_missing(job):
    machine = dataclasses.replace(SLIDE, dry=lambda t, y, v, f: 0.15 * abs(f))
    job.runs(machine, velocity=0.002)
    job.declare(machine)
    job.truth["load_friction.mu"] = 0.15


@situation(EXPLAINED, "the missing friction is in the catalogue", "position_friction")
def position_friction_missing(job):
    machine = dataclasses.replace(GANTRY, dry=lambda t, y, v, f: 200.0 * y)
    job.runs(machine, position=20e-6)
    job.declare(machine)
    job.truth["position_friction.G_c"] = 200.0


@situation(EXPLAINED, "the missing weight is in the catalogue, under two names that are equivalent",
           "constant_force", "directional_friction")  # fmt: skip
def gravity_missing(job):
    lift = dataclasses.replace(SLIDE, F_0=-12.0 * 9.81, F_max=350.0)
    job.runs(lift, velocity=0.002)
    job.declare(lift, free="M B_a F_c")
    job.truth["constant_force.F_0"] = lift.F_0


@situation(EXPLAINED, "the missing force of the magnets is in the catalogue", "periodic_force")
def cogging_missing(job):
    pull = 2 * math.pi / 0.024
    machine = dataclasses.replace(MOTOR, force=lambda t, y, v: 5.0 * math.sin(pull * y + 0.4))
    job.runs(machine, position=5e-6, velocity=0.005)
    job.declare(machine)
    job.truth.update({"periodic_force.F_s1": 5 * math.cos(0.4),
                      "periodic_force.F_c1": 5 * math.sin(0.4),
                      "periodic_force.period": 0.024})  # fmt: skip


@situation(EXPLAINED, "both missing effects are in the catalogue", "quadratic_drag",
           "periodic_force")  # fmt: skip
def two_effects_missing(job):
    def force(t, y, v):
        return 6.0 * math.sin(2 * math.pi * y / 0.04) - 12.0 * v * abs(v)

    machine = dataclasses.replace(SLIDE, force=force)
    job.runs(machine, position=10e-6, velocity=0.002)
    job.declare(machine)
    job.truth.update({"periodic_force.F_s1": 6.0, "periodic_force.period": 0.04,
                      "quadratic_drag.c": 12.0})  # fmt: skip


@situation(EXPLAINED, "the missing friction is in the catalogue", "coulomb_friction")
def robot_coulomb_missing(job):
    job.robot_runs(true={"F_c": 40.0}, **ROBOT_NOISE)
    job.declare_robot()
    job.truth["coulomb_friction.F_c"] = 40.0


@situation(EXPLAINED, "the missing mass is in the catalogue", "added_mass")
def robot_payload_missing(job):
    job.robot_runs(true={"M": 166.0}, **ROBOT_NOISE)
    job.declare_robot()
    job.truth["added_mass.dM"] = 20.0


class Elastoplastic:
    """Springs of these stiffnesses that yield at these travels: friction with a memory."""

    def __init__(self, *springs):
        self.springs, self.bent, self.y = springs, [0.0] * len(springs), 0.0

    def __call__(self, t, y, v):
        moved, self.y = y - self.y, y
        self.bent = [min(max(b + moved, -r), r) for b, (_, r) in zip(self.bent, self.springs)]
        return -sum(k * b for b, (k, _) in zip(self.bent, self.springs))


@situation(USABLE, "a hysteresis that no effect describes; dahl_friction is near it", "dahl_friction")
def hysteresis(job):
    for role in ("fit", "validate"):
        machine = dataclasses.replace(SLIDE, force=Elastoplastic((60e3, 0.2e-3), (900, 0.02)))
        log = machine.run(follow(machine, path(job.rng, 4.0)), 4.0, 500)
        job.add(job.measure(log, velocity=0.002), role)
    job.declare(SLIDE)
    job.truth = {}


@situation(MODEL_WRONG, "a hidden hysteresis takes most of the force", loop=False)
def hysteresis_large(job):
    for role in ("fit", "validate"):
        machine = dataclasses.replace(RUBBING, F_c=5.0, force=Elastoplastic((800, 0.03), (300, 0.1)))
        log = machine.run(follow(machine, path(job.rng, 4.0, most=1.0)), 4.0, 500)
        job.add(job.measure(log, position=10e-6), role)
    job.declare(dataclasses.replace(RUBBING, F_c=5.0))
    job.truth = {}


@situation(EXPLAINED, "backlash is declared as zero", "backlash")
def robot_backlash_undeclared(job):
    job.robot_runs(true={"H": 0.1e-3}, **ROBOT_NOISE)
    job.declare_robot(H=0.0)


# Nothing can be determined.


@situation(NOTHING_DETERMINED, "the motor is off and nothing moves: there is only noise")
def motor_off(job):
    for role in ("fit", "validate"):
        log = SLIDE.run(lambda t, y, v: 0.0, 3.0)
        job.add(job.measure(log, velocity=0.002), role)
    job.declare(SLIDE, free="M B_a F_c")


@situation(NOTHING_DETERMINED, "the brake is closed: only a lower limit of the friction shows")
def brake_closed(job):
    def closed(record, log):
        record["velocity"] = [job.rng.gauss(0.0, 0.002) for _ in log["time"]]

    job.runs(SLIDE, change=closed)
    job.declare(SLIDE)
    job.truth = {}


@situation(NOTHING_DETERMINED, "one speed shows one force: the sum of all frictions")
def one_speed(job):
    force = SLIDE.F_c + SLIDE.B * 0.5 - SLIDE.F_0
    log = SLIDE.run(lambda t, y, v: force / SLIDE.K_f, 4.0, v=0.5)
    job.add(job.measure(log, velocity=0.002))
    job.declare(SLIDE)
    job.axis["initial"] = {"y1": "0.5 m/s"}


@situation(NOTHING_DETERMINED, "the pinion moves within the backlash: the arm stands still")
def robot_tiny_motion(job):
    for role, f in (("fit", 7.0), ("validate", 11.0)):
        log = robot(lambda t, f=f: 0.05 * math.cos(2 * math.pi * f * t), H=0.3e-3)
        job.add(job.measure(log, velocity=0.002, acceleration=0.05), role)
    job.declare_robot(free="M B_a b_g k_g", H=0.3e-3)


@situation(EXPLAINED, "right, and the friction is determined; the mass is not: nothing accelerates",
           loop=False)  # fmt: skip
def steady_speeds(job):
    for speed in (-0.8, -0.4, -0.15, 0.15, 0.4, 0.8, 0.6):
        force = math.copysign(SLIDE.F_c, speed) + SLIDE.B * speed - SLIDE.F_0
        log = SLIDE.run(lambda t, y, v, force=force: force / SLIDE.K_f, 0.6, v=speed)
        job.add(job.measure(log, velocity=0.002), "validate" if speed == 0.6 else "fit",
                set={"initial.y1": with_unit(speed, "m/s")})  # fmt: skip
    job.declare(SLIDE)


# The command has nothing to do with the motion.


@situation(MODEL_WRONG, "the recorded signal is noise, whatever the command")
def noise_motor_on(job):
    def noise(record, log):
        record["velocity"] = [job.rng.gauss(0.0, 0.3) for _ in log["time"]]

    job.runs(SLIDE, change=noise)
    job.declare(SLIDE)
    job.truth = {}


@situation(MODEL_WRONG, "command and motion are of different runs")
def unrelated_motion(job):
    def other(record, log):
        run = SLIDE.run(follow(SLIDE, path(job.rng, 4.0)))
        record["velocity"] = job.measure(run, velocity=0.002)["velocity"]

    job.runs(SLIDE, change=other)
    job.declare(SLIDE)
    job.truth = {}


@situation(MODEL_WRONG, "the command is that of another axis")
def robot_other_command(job):
    def other(record, log):
        drive = levels(job.rng)
        record["command"] = [drive(t) for t in log["time"]]

    job.robot_runs(change=other, **ROBOT_NOISE)
    job.declare_robot()
    job.truth = {}


@situation(MODEL_WRONG, "what is called the force is the set position")
def command_is_position(job):
    for role in ("fit", "validate"):
        reference = path(job.rng, 4.0)
        log = SLIDE.run(follow(SLIDE, reference))
        record = job.measure(log, velocity=0.002)
        record["command"] = [10.0 * reference(t)[0] for t in log["time"]]
        job.add(record, role)
    job.declare(SLIDE)
    job.truth = {}


# Another machine.


class Load:
    """A second mass (kg) on the slide, on a spring: the frequency (Hz) is that of the spring and
    this mass alone. `drive` also notes its velocity, once per sample."""

    def __init__(self, mass, frequency, damping=0.03, h=1e-4):
        w = 2 * math.pi * frequency
        self.mass, self.k, self.d, self.h = mass, mass * w * w, 2 * damping * w * mass, h
        self.y = self.v = 0.0
        self.seen = []

    def __call__(self, t, y, v):
        f = self.k * (y - self.y) + self.d * (v - self.v)
        self.v += self.h * f / self.mass
        self.y += self.h * self.v
        return -f

    def drive(self, inner):
        def noting(t, y, v):
            self.seen.append(self.v)
            return inner(t, y, v)

        return noting


def two_masses(job, frequency, on_load):
    for role in ("fit", "validate"):
        load = Load(5.0, frequency)
        machine = dataclasses.replace(SLIDE, M=7.0, force=load)
        log = machine.run(load.drive(follow(SLIDE, path(job.rng, 4.0), 15.0)), 4.0)
        if on_load:
            log["velocity"] = load.seen
        job.add(job.measure(log, velocity=0.002), role)
    job.declare(SLIDE)
    job.truth = {}


@situation(USABLE, "the resonance between drive and recorded load is not in the catalogue",
           "elastic_mode")  # fmt: skip
def two_masses_load(job):
    two_masses(job, 12.0, True)


@situation(EXPLAINED, "the mass that swings on the recorded one is in the catalogue",
           "elastic_mode")  # fmt: skip
def two_masses_motor(job):
    two_masses(job, 12.0, False)
    job.truth = {"M": SLIDE.M, "elastic_mode.m_e": 5.0, "elastic_mode.f_e": 12.0,
                 "elastic_mode.zeta_e": 0.03}  # fmt: skip


def pendulum(job):
    machine = dataclasses.replace(
        SLIDE, F_0=0.0, force=lambda t, y, v: -machine.M * 9.81 * math.sin(y / 0.3))
    job.runs(machine, motion={"least": 0.5, "most": 1.2, "stroke": 0.4}, velocity=0.002)
    job.declare(machine, free="M B_a F_c")


@situation(EXPLAINED, "the weight of the pendulum is a force over the position, with its period",
           "periodic_force", "force_over_position", "stroke_spring")  # fmt: skip
def pendulum_as_slide(job):
    pendulum(job)


@situation(MODEL_WRONG, "the weight of the pendulum, most of the force, is missing", loop=False)
def pendulum_no_loop(job):
    pendulum(job)


@situation(USABLE, "the reaction of another axis, of which nothing is recorded", "force_over_time")
def neighbour(job):
    for role in ("fit", "validate"):
        other = path(job.rng, 4.0, rest=1.0)
        machine = dataclasses.replace(SLIDE, force=lambda t, y, v, other=other: -2.0 * other(t)[2])
        log = machine.run(follow(machine, path(job.rng, 4.0)))
        job.add(job.measure(log, velocity=0.002), role)
    job.declare(SLIDE)
    job.truth = {}


# Columns and instruments.


def scale(signal, factor):
    def change(record, log):
        record[signal] = [factor * x for x in record[signal]]

    return change


@situation(MODEL_WRONG, "the velocity has the wrong sign, and the position the right one",
           loop=False)  # fmt: skip
def velocity_sign(job):
    job.runs(SLIDE, change=scale("velocity", -1.0), position=10e-6, velocity=0.002)
    job.declare(SLIDE)
    job.truth = {}


@situation(EXPLAINED, "the velocity is in mm/s, declared m/s: a wrong gain, which can be found",
           "velocity.gain")  # fmt: skip
def velocity_unit(job):
    job.runs(SLIDE, change=scale("velocity", 1000.0), position=10e-6, velocity=0.002)
    job.declare(SLIDE)
    job.truth["velocity.gain"] = 1000.0


@situation(EXPLAINED, "the position is in mm, declared m: a mass of grams explains it", loop=False)
def position_unit(job):
    job.runs(SLIDE, change=scale("position", 1000.0), position=10e-6)
    job.declare(SLIDE)
    job.truth = {}


@situation(MODEL_WRONG, "the acceleration has the wrong sign, and the velocity the right one",
           loop=False)  # fmt: skip
def robot_acceleration_sign(job):
    job.robot_runs(change=scale("acceleration", -1.0), **ROBOT_NOISE)
    job.declare_robot()
    job.truth = {}


@situation(USABLE, "the sensor is clipped at 60 % of the highest speed")
def saturated_sensor(job):
    def clip(record, log):
        most = 0.6 * max(abs(v) for v in log["velocity"])
        record["velocity"] = [min(max(v, -most), most) for v in record["velocity"]]

    job.runs(SLIDE, change=clip, velocity=0.002)
    job.declare(SLIDE)
    job.truth = {}


@situation(USABLE, "a filter without delay smooths the velocity; no effect is such a filter")
def moving_average(job):
    def smooth(record, log):
        v = record["velocity"]
        record["velocity"] = [statistics.fmean(v[max(k - 10, 0) : k + 11]) for k in range(len(v))]

    job.runs(MOTOR, change=smooth, seconds=2.0, rate=1000, velocity=0.002)
    job.declare(MOTOR)


@situation(USABLE, "the velocity is held for ten samples, which is late by 4.5 on average",
           *LATER)  # fmt: skip
def held_ten(job):
    def hold(record, log):
        v = record["velocity"]
        record["velocity"] = [v[k - k % 10] for k in range(len(v))]

    job.runs(MOTOR, change=hold, seconds=2.0, rate=1000, velocity=0.002)
    job.declare(MOTOR)


@situation(USABLE, "the velocity was recorded at 50 Hz and interpolated to 1 kHz")
def interpolated(job):
    def interpolate(record, log):
        v = record["velocity"][::20]
        record["velocity"] = [at(v, k / 20) for k in range(len(log["time"]))]

    job.runs(MOTOR, change=interpolate, seconds=2.0, rate=1000, velocity=0.002)
    job.declare(MOTOR)


def late(samples, signal="velocity"):
    def change(record, log):
        record[signal] = shift(record[signal], samples)

    return change


@situation(EXPLAINED, "the delay of 5 ms is in the catalogue", *LATER)
def delay_5_ms(job):
    job.runs(SLIDE, change=late(5), seconds=2.0, rate=1000, velocity=0.002)
    job.declare(SLIDE)
    job.truth["velocity.delay"] = job.truth["T_d"] = 0.005


@situation(USABLE, "the velocity is 20 ms late", loop=False)
def delay_20_ms_no_loop(job):
    job.runs(SLIDE, change=late(20), seconds=2.0, rate=1000, velocity=0.002)
    job.declare(SLIDE)


@situation(EXPLAINED, "the command is logged 10 ms late: the motion is early, which can be found", *LATER)
def command_late(job):
    job.runs(SLIDE, change=late(10, "command"), seconds=2.0, rate=1000, velocity=0.002)
    job.declare(SLIDE)
    job.truth["velocity.delay"] = -0.010


@situation(USABLE, "the clock of the velocity is 1 % slow: a delay that grows to 40 ms", "velocity.drift", *LATER)
def clock_drift(job):
    def drift(record, log):
        record["velocity"] = [at(record["velocity"], 0.99 * k) for k in range(len(log["time"]))]

    job.runs(SLIDE, change=drift, velocity=0.002)
    job.declare(SLIDE)


@situation(EXPLAINED, "the true axis; samples taken up to 0.6 ms early or late are noise")
def sampling_jitter(job):
    def jitter(record, log):
        record["velocity"] = [v + a * job.rng.uniform(-0.6e-3, 0.6e-3)
                              for v, a in zip(record["velocity"], log["acceleration"])]  # fmt: skip

    job.runs(SLIDE, change=jitter, velocity=0.002)
    job.declare(SLIDE)


@situation(EXPLAINED, "the true axis; the velocity is known to a third of its range only")
def three_levels(job):
    def round_off(record, log):
        step = 0.8 * max(abs(v) for v in log["velocity"])
        record["velocity"] = [round(v / step) * step for v in log["velocity"]]

    job.runs(SLIDE, change=round_off, velocity=0.0)
    job.declare(SLIDE)


@situation(USABLE, "the zero of the velocity drifts, by 0.12 m/s in 4 s", "velocity.bias")
def sensor_drift(job):
    def drift(record, log):
        record["velocity"] = [v + 0.03 * t for v, t in zip(record["velocity"], record["time"])]

    job.runs(SLIDE, change=drift, velocity=0.002)
    job.declare(SLIDE)


@situation(EXPLAINED, "the offset of the velocity is in the catalogue", "velocity.bias")
def sensor_offset(job):
    def offset(record, log):
        record["velocity"] = [v + 0.02 for v in record["velocity"]]

    job.runs(SLIDE, change=offset, position=10e-6, velocity=0.002)
    job.declare(SLIDE)
    job.truth["velocity.bias"] = 0.02


@situation(EXPLAINED, "the true axis; one sample in a hundred is wrong by up to 1 m/s")
def outliers(job):
    def spoil(record, log):
        for k in job.rng.sample(range(len(log["time"])), len(log["time"]) // 100):
            record["velocity"][k] += job.rng.uniform(-1.0, 1.0)

    job.runs(SLIDE, change=spoil, velocity=0.002)
    job.declare(SLIDE)


@situation(USABLE, "the velocity reads zero in three stretches of 60 ms")
def dropouts(job):
    def drop(record, log):
        for begin in job.rng.sample(range(100, len(log["time"]) - 100), 3):
            record["velocity"][begin : begin + 30] = [0.0] * 30

    job.runs(SLIDE, change=drop, velocity=0.002)
    job.declare(SLIDE)


@situation(EXPLAINED, "the true axis; the noise is coloured")
def coloured_noise(job):
    def colour(record, log):
        x = 0.0
        for k, v in enumerate(log["velocity"]):
            x = 0.95 * x + job.rng.gauss(0.0, 0.002)
            record["velocity"][k] = v + x

    job.runs(SLIDE, change=colour, velocity=0.0)
    job.declare(SLIDE)


@situation(EXPLAINED, "the true axis; the noise has heavy tails")
def heavy_tails(job):
    def tails(record, log):
        for k, v in enumerate(log["velocity"]):
            squares = sum(job.rng.gauss(0.0, 1.0) ** 2 for _ in range(3))
            record["velocity"][k] = v + 0.002 * job.rng.gauss(0.0, 1.0) / math.sqrt(squares / 3)

    job.runs(SLIDE, change=tails, velocity=0.0)
    job.declare(SLIDE)


def noisy_command(part):
    def change(record, log):
        sigma = part * (max(log["command"]) - min(log["command"]))
        record["command"] = [u + job_noise.gauss(0.0, sigma) for u in log["command"]]

    job_noise = random.Random(f"command {part}")
    return change


@situation(EXPLAINED, "the true axis; noise of 0.1 % of the range in the command is too small to show")
def command_noise_0_1(job):
    job.runs(SLIDE, change=noisy_command(0.001), velocity=0.002)
    job.declare(SLIDE)


@situation(EXPLAINED, "the true axis; noise of 1 % of the range in the command shows at most as noise")
def command_noise_1(job):
    job.runs(SLIDE, change=noisy_command(0.01), velocity=0.002)
    job.declare(SLIDE)


@situation(USABLE, "noise of 5 % of the range in the command drives the model, but not the axis")
def command_noise_5(job):
    job.runs(SLIDE, change=noisy_command(0.05), velocity=0.002)
    job.declare(SLIDE)


# Constants that are not free.


@situation(EXPLAINED, "K_f is 20 % too high, and mass and friction with it: their ratios are right")
def force_constant(job):
    job.runs(SLIDE, velocity=0.002)
    job.declare(SLIDE, K_f=1.2 * SLIDE.K_f)


@situation(EXPLAINED, "T_z is 8 ms, not 7.05 ms, and is not free", "T_z")
def robot_wrong_T_z(job):
    job.robot_runs(true={"T_z": 8e-3}, **ROBOT_NOISE)
    job.declare_robot()


@situation(EXPLAINED, "J_m is 30 % higher than declared, and is not free", "J_m")
def robot_wrong_J_m(job):
    job.robot_runs(true={"J_m": 1.3 * ROBOT["J_m"]}, **ROBOT_NOISE)
    job.declare_robot()


@situation(EXPLAINED, "r_g is 10 % smaller than declared, and is not free, but M is", "r_g")
def robot_wrong_r_g(job):
    job.robot_runs(velocity=0.002, tachometer=0.005)
    job.declare_robot(free="M V_L B_a T_p", r_g=1.1 * ROBOT["r_g"])


@situation(USABLE, "the bounds of the mass exclude the truth by 20 %", loop=False)
def bound_excludes(job):
    job.runs(SLIDE, velocity=0.002)
    job.declare(SLIDE)
    job.free["M"] = {"bounds": ["2 kg", "9.6 kg"]}


# Files.


@situation(REFUSED, "the recording that is fitted cannot validate the fit")
def one_file_fit_and_validate(job):
    job.runs(SLIDE, validate=False, velocity=0.002)
    job.add(job.files["fit1.csv"], "validate", file="fit1.csv")
    job.declare(SLIDE)


@situation(REFUSED, "a recording that counts twice makes the errors look smaller")
def one_file_twice(job):
    job.runs(SLIDE, validate=False, velocity=0.002)
    job.add(job.files["fit1.csv"], "fit", file="fit1.csv")
    job.declare(SLIDE)


@situation(REFUSED, "a copy of the fitted recording cannot validate the fit either")
def copy_validates(job):
    job.runs(SLIDE, validate=False, velocity=0.002)
    job.add(job.files["fit1.csv"], "validate", file="second-run.csv")
    job.declare(SLIDE)


# The machine changes.


def change_to_validate(job, other, machine=SLIDE, **motion):
    for role, now in (("fit", machine), ("validate", other)):
        log = now.run(follow(machine, path(job.rng, 4.0, **motion)))
        job.add(job.measure(log, velocity=0.002), role)
    job.declare(machine)


@situation(USABLE, "a payload of 30 % in the recording to validate")
def validate_payload(job):
    change_to_validate(job, dataclasses.replace(SLIDE, M=1.3 * SLIDE.M))


@situation(USABLE, "three times the friction in the recording to validate, as on another day")
def validate_friction(job):
    tight = dataclasses.replace(RUBBING, F_c=3 * RUBBING.F_c)
    change_to_validate(job, tight, RUBBING, least=0.5, most=1.0)


@situation(USABLE, "a brake drags with a sixth of the force from half-way on")
def brake_half_way(job):
    machine = dataclasses.replace(SLIDE, dry=lambda t, y, v, f: 15.0 if t > 2.0 else 0.0)
    job.runs(machine, velocity=0.002)
    job.declare(SLIDE)
    job.truth = {}


@situation(USABLE, "a third of the mass is put down half-way")
def payload_dropped(job):
    machine = dataclasses.replace(SLIDE, mass=lambda t: 12.0 if t < 2.0 else 8.0)
    job.runs(machine, velocity=0.002)
    job.declare(SLIDE)
    job.truth = {}


@situation(EXPLAINED, "friction that falls to a third as it warms up, over 20 s", "warming_friction")
def friction_warms_up(job):
    machine = dataclasses.replace(SLIDE, dry=lambda t, y, v, f: 18.0 * math.exp(-t / 7.0))
    job.runs(machine, seconds=20.0, rate=100, motion={"least": 0.4, "most": 0.9}, velocity=0.002)
    job.declare(machine)
    job.truth = {"M": SLIDE.M, "B_a": SLIDE.B}


@situation(USABLE, "the supply voltage, and the force with it, sags and recovers by 20 %")
def supply_sags(job):
    machine = dataclasses.replace(SLIDE, supply=lambda t: 0.9 + 0.1 * math.cos(4.0 * t))
    job.runs(machine, velocity=0.002)
    job.declare(SLIDE)
    job.truth = {}


# Running and judging.


def grade_of(code, result):
    if code == 2:
        return REFUSED
    if code not in (0, 3, 124) or result is None:
        return f"exit code {code}"
    if "grade" in result:
        return result["grade"]
    if not result["usable"]:
        return NOT_CONVERGED
    residual = result["residual"]
    explained = residual and all(t["explained"] for t in residual["tests"])
    return EXPLAINED if explained else USABLE


def largest_error(job, result):
    """Of the simulation, in per cent of the standard deviation of the measured signal."""
    largest = 0.0
    for given, found in zip(job.recordings, result["recordings"]):
        for signal in found["signals"]:
            if signal["rmse"] is None:
                return math.inf
            spread = statistics.pstdev(job.files[given["file"]][signal["name"]])
            largest = max(largest, 100.0 * signal["rmse"] / spread if spread else math.inf)
    return largest


def worst_parameter(job, result):
    worst = (0.0, "")
    for p in result["parameters"]:
        if p["name"] in job.truth and p["verdict"] == "determined":
            errors = abs(p["value"] - job.truth[p["name"]]) / p["standard_error"]
            worst = max(worst, (errors, p["name"]))
    return worst


@dataclasses.dataclass
class Judgement:
    given: str
    wrong_effects: list
    error: float
    worst: tuple
    passed: bool
    strict: bool
    seconds: float


def write_situation(name, folder):
    """Writes recordings, axis.yaml and job.yaml to the folder."""
    job = Job(name)
    SITUATIONS[name].make(job)
    job.write(folder)
    return job


def judge(name, program, keep=None):
    what = SITUATIONS[name]
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(keep, name) if keep else pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        job = write_situation(name, folder)
        begin = time.monotonic()
        done = subprocess.run(
            [program, "job.yaml", "--json", "--time-limit", "60", "--threads", "1",
             *(["--close-loop"] if what.loop else [])],
            cwd=folder, capture_output=True, text=True)  # fmt: skip
        seconds = time.monotonic() - begin
        if keep:
            pathlib.Path(folder, "result.json").write_text(done.stdout)
            pathlib.Path(folder, "errors.txt").write_text(done.stderr)
    result = json.loads(done.stdout) if done.stdout.strip() else None
    given = grade_of(done.returncode, result)
    accepted = [e["name"] for e in (result or {}).get("effects", []) if e["accepted"]]
    wrong = [e for e in accepted if e not in what.effects]
    not_better = given in GRADES and GRADES.index(given) >= GRADES.index(what.deserved)
    return Judgement(
        given + (" (time)" if done.returncode == 124 else ""), wrong,
        largest_error(job, result) if result else math.nan,
        worst_parameter(job, result) if result else (0.0, ""),
        not_better and not wrong, not_better and given != what.deserved, seconds)  # fmt: skip


def print_counts(counts):
    """How many situations deserved a grade (rows) and were given one (columns)."""
    grades = [g for g in GRADES if any(g in pair for pair in counts)]
    print(f"{'deserved, given':<20}" + "".join(f"{g:>20}" for g in grades))
    for row in grades:
        cells = [counts[row, column] or "-" for column in grades]
        if any(c != "-" for c in cells):
            print(f"{row:<20}" + "".join(f"{c:>20}" for c in cells))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("build", nargs="?", type=pathlib.Path, default=ROOT / "build" / "release")
    parser.add_argument("--only", nargs="+", choices=SITUATIONS, metavar="NAME")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="fits at the same time")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for the files of all situations")
    parser.add_argument("--list", action="store_true", help="print the situations and stop")
    options = parser.parse_args()
    if options.list:
        for name, what in SITUATIONS.items():
            print(f"{name:<26} {what.deserved:<18} {what.reason}")
        return 0
    names = options.only or list(SITUATIONS)
    program = (options.build / "apps" / "fit-params").resolve()
    print(f"{'situation':<26} {'deserved':<18} {'given':<25} {'error':>8}  {'worst parameter':<32} "
          f"{'s':>4}  effects claimed wrongly")  # fmt: skip
    passed = 0
    counts = collections.Counter()
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        judged = pool.map(judge, names, [program] * len(names), [options.keep] * len(names))
        for name, j in zip(names, judged):
            passed += j.passed
            counts[SITUATIONS[name].deserved, j.given.split()[0]] += 1
            worst = f"{j.worst[0]:6.1f} {j.worst[1]}" if j.worst[1] else ""
            verdict = ("strict" if j.strict else "pass") if j.passed else "FAIL"
            print(f"{name:<26} {SITUATIONS[name].deserved:<18} {j.given:<25} {j.error:>7.1f}%  "
                  f"{worst:<32} {j.seconds:>4.0f}  {verdict} {' '.join(j.wrong_effects)}",
                  flush=True)  # fmt: skip
    print(f"{passed} of {len(names)} pass\n")
    print_counts(counts)
    return 0 if passed == len(names) else 1


if __name__ == "__main__":
    sys.exit(main())
