"""fit-params --close-loop on a case: what it claims, and the force that its model lacks in a recording
that it has not seen, from the same signals as the alternatives.

Inverse dynamics of the final model: the laws of docs/effects.md with the estimates of result.json. A
sensor effect changes the signals first, timing shifts them, and what is behind a spring or a gap is
simulated behind the motor's motion. What the drive and friction by load take of the force is taken of the
force that the model predicts, not of the recorded one.
"""
import dataclasses
import json
import math
import os
import subprocess
import time

import numpy as np
from scipy import interpolate, signal

from regression import force_for, hysteresis, kinematics, missing


class Unknown(Exception):
    """A name that no law here stands for."""


@dataclasses.dataclass
class Outcome:
    grade: str
    accepted: list
    undecided: list
    trials: list  # of every effect refitted: name, decision, reason and so on
    values: dict  # of the final model, by name
    chi_square: float  # of the declared model
    seconds: float  # processor time of one thread, or elapsed with several
    verdict: str


def run(program, job, folder, arguments=(), limit=900, threads=1):
    """Runs a job and leaves result.json and errors.txt in the folder; none where it fails."""
    command = [program, job, "--close-loop", "--threads", str(threads), "--json",
               "--time-limit", str(limit)]  # fmt: skip
    begin = time.monotonic()
    with open(folder / "result.json", "w") as out, open(folder / "errors.txt", "w") as errors:
        child = subprocess.Popen([*command, *arguments], stdout=out, stderr=errors)
        _, status, used = os.wait4(child.pid, 0)  # the time of this child alone
    elapsed = time.monotonic() - begin
    child.returncode = os.waitstatus_to_exitcode(status)
    text = (folder / "result.json").read_text()
    if child.returncode not in (0, 3, 124) or not text.strip():
        return None
    result = json.loads(text)
    effects = result.get("effects", [])
    named = lambda decision: [e["name"] for e in effects if e["decision"] == decision]
    grade = result["grade"] + (" (time)" if child.returncode == 124 else "")
    return Outcome(grade, named("accepted"), named("undecided"), effects,
                   {p["name"]: p["value"] for p in result["parameters"]},
                   result.get("before", {}).get("reduced_chi_square", np.nan),
                   used.ru_utime + used.ru_stime if threads == 1 else elapsed,
                   result.get("selection", {}).get("verdict", result["verdict"]))  # fmt: skip


def shifted(values, time, by):
    """The value at t + by, held at the ends."""
    return np.interp(time + by, time, values)


def spline(values, x, low, high):
    """A force curve: cubic B-splines with 16 coefficients, constant beyond the ends."""
    s = np.clip((x - low) / (high - low) * 13.0, 0.0, 13.0)
    first = np.minimum(s.astype(int), 12)
    t, c = s - first, np.asarray(values)
    return (c[first] * (1 - t) ** 3 + c[first + 1] * (4 - 6 * t**2 + 3 * t**3)
            + c[first + 2] * (1 + 3 * t + 3 * t**2 - 3 * t**3) + c[first + 3] * t**3) / 6.0  # fmt: skip


def elastic(k, p):
    """What a part of the mass on a spring makes of the force that it would take if it were rigid."""
    if p["m_e"] == 0.0:
        return np.zeros_like(k.v)
    w = 2 * np.pi * p["f_e"]
    part = {"M": p["m_e"], "B_a": 0.0, "H": 0.0, "k_g": p["m_e"] * w * w,
            "b_g": 2.0 * p.get("zeta_e", 0.02) * w * p["m_e"]}  # fmt: skip
    return behind_gap(k, part, 0.0, np.zeros_like(k.v)) - p["m_e"] * k.a


def curve(of):
    return lambda k, p: -spline([p.get(f"c{i}", 0.0) for i in range(1, 17)], of(k), p["from"], p["to"])


def dahl(k, p):
    build_up = hysteresis(k, p["l_d"])
    return p["F_d"] * build_up + p.get("B_d", 0.0) * k.v * (1.0 - build_up * k.direction)


# Force in N that the drive needs for the effect.
LAWS = {
    "coulomb_friction": lambda k, p: p["F_c"] * k.direction,
    "constant_force": lambda k, p: -p["F_0"] * np.ones_like(k.v),
    "quadratic_drag": lambda k, p: p["c"] * k.direction * np.abs(k.v) ** p.get("n", 2.0),
    "directional_friction": lambda k, p: p.get("dB_a", 0.0) * np.abs(k.v)
    + p.get("dF_c", 0.0) * np.abs(k.direction),
    "stribeck_friction": lambda k, p: p["F_st"] * k.direction
    * np.exp(-(np.abs(k.v) / p["v_st"]) ** p.get("n", 1.0)),
    "position_friction": lambda k, p: (p.get("G_c", 0.0) * k.y + p.get("G_q", 0.0) * k.y**2)
    * k.direction + p.get("G_b", 0.0) * k.y * k.v,
    "friction_bump": lambda k, p: p["F_b"] * k.direction * np.exp(-(((k.y - p["y_b"]) / p["w_b"]) ** 2)),
    "dahl_friction": dahl,
    "second_dahl_friction": dahl,
    "warming_friction": lambda k, p: p["F_w"] * k.direction * np.exp(-k.time / p["t_w"]),
    "warming_grease": lambda k, p: p["B_w"] * k.v * np.exp(-k.time / p["t_b"]),
    "running_in_friction": lambda k, p: p["F_r"] * k.direction
    * np.exp(-np.concatenate([[0.0], np.cumsum(np.abs(np.diff(k.y)))]) / p["l_r"]),
    "pendulum_gravity": lambda k, p: p.get("G_s", 0.0) * np.sin(k.y) + p.get("G_c", 0.0) * np.cos(k.y),
    "stroke_spring": lambda k, p: p["k_s"] * k.y,
    "periodic_force": lambda k, p: -sum(
        p.get(f"F_{part}{n}", 0.0) * of(2 * np.pi * n * k.y / p["period"])
        for part, of in (("s", np.sin), ("c", np.cos)) for n in (1, 2, 3)),
    "added_mass": lambda k, p: p["dM"] * k.a,
    "elastic_mode": elastic,
    "force_over_velocity": curve(lambda k: k.v),
    "force_over_position": curve(lambda k: k.y),
    "force_over_time": curve(lambda k: k.time),
    "friction_over_velocity": lambda k, p: -curve(lambda k: np.abs(k.v))(k, p) * k.direction,
    "friction_over_position": lambda k, p: -curve(lambda k: k.y)(k, p) * k.direction,
}  # fmt: skip

# What friction by load takes of a force.
LOAD_LAWS = {
    "load_friction": lambda f, k, p: p["mu"] * np.abs(f) * k.direction,
    "quadratic_load_friction": lambda f, k, p: p["mu_q"] * f**2 * k.direction,
    "stribeck_load_friction": lambda f, k, p: p["mu_st"] * np.abs(f) * k.direction
    * np.exp(-np.abs(k.v) / p["v_l"]),
}  # fmt: skip


def behind_gap(k, base, dry, others):
    """The force between the motor, whose motion is recorded, and an arm behind a gap, with dry friction
    that turns round over 0.1 mm/s, and the force of all other laws. The arm by Runge-Kutta steps of the
    fourth order, the motor between samples by the cubic through its positions and velocities."""
    steps, creep = 40, 1e-4  # per sample, m/s
    h = 1.0 / (k.rate * steps)
    course = interpolate.CubicHermiteSpline(k.time, k.y, k.v)
    at = k.time[0] + 0.5 * h * np.arange(2 * steps * (len(k.time) - 1) + 1)
    motor_y, motor_v = course(at).tolist(), course.derivative()(at).tolist()
    loads = np.interp(at, k.time, others).tolist()
    gap, stiffness, damping = base["H"], base["k_g"], base["b_g"]
    mass, viscous = base["M"], base["B_a"]

    def gear_force(i, y, v):
        apart = motor_y[i] - y
        beyond = apart - min(max(apart, -gap), gap)
        return stiffness * beyond + damping * (motor_v[i] - v) if beyond or not gap else 0.0

    def rate(i, y, v):
        return (gear_force(i, y, v) - viscous * v - loads[i] - dry * math.tanh(v / creep)) / mass

    y, v = motor_y[0], motor_v[0]
    carried = []
    for i in range(0, len(at) - 1, 2):
        if i % (2 * steps) == 0:
            carried.append(gear_force(i, y, v))
        a1 = rate(i, y, v)
        v2 = v + 0.5 * h * a1
        a2 = rate(i + 1, y + 0.5 * h * v, v2)
        v3 = v + 0.5 * h * a2
        a3 = rate(i + 1, y + 0.5 * h * v2, v3)
        v4 = v + h * a3
        a4 = rate(i + 2, y + h * v3, v4)
        y += h / 6.0 * (v + 2.0 * (v2 + v3) + v4)
        v += h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)
    return np.array([*carried, gear_force(len(at) - 1, y, v)])


ELSEWHERE = ("torque_fade", "force_droop", "drive_lag")  # they change the force that arrives


def grouped(values):
    """Parameters by effect: {"": base, "coulomb_friction": {"F_c": ...}, ...}."""
    groups = {}
    for name, value in values.items():
        group, _, symbol = name.rpartition(".")
        groups.setdefault(group, {})[symbol] = value
    return groups


def corrected(recording, groups):
    """The recording with the effects of its instruments taken back."""
    instrument = next((groups[name] for name in ("position", "velocity") if name in groups), {})
    late = instrument.get("delay", 0.0) + instrument.get("lag", 0.0)
    changed = {}
    for name in ("position", "velocity", "acceleration"):  # one of them is what the instrument shows
        if (values := getattr(recording, name)) is None:
            continue
        bias = groups.get(name, {}).get("bias", 0.0)
        values = (values - bias) / instrument.get("gain", 1.0)
        changed[name] = shifted(values, recording.time, late) if late else values
    return dataclasses.replace(recording, **changed)


def lacking(values, recording):
    """rms in N of the force that a model with these values lacks where the axis moves, in the band in which
    forces are compared."""
    groups = grouped(values)
    base = groups.get("", {})
    k = kinematics(corrected(recording, groups))
    force = shifted(k.force, k.time, -base.get("T_d", 0.0))
    if "drive_lag" in groups and groups["drive_lag"]["T_l"] > 0.0:
        follow = signal.cont2discrete(([1.0], [groups["drive_lag"]["T_l"], 1.0]), 1.0 / k.rate,
                                      "bilinear")  # fmt: skip
        force = signal.lfilter(follow[0][0], follow[1], force)
    needed = np.zeros_like(k.v)
    for effect, parameters in groups.items():
        if effect in LAWS:
            needed = needed + LAWS[effect](k, parameters)
        elif effect not in ("", "position", "velocity", "initial", *ELSEWHERE, *LOAD_LAWS):
            raise Unknown(effect)
    if "J_m" in base:  # r_g is 1 m
        dry = groups.get("coulomb_friction", {"F_c": 0.0})["F_c"]
        others = needed - dry * k.direction
        needed = base["J_m"] * k.a + behind_gap(k, {"H": 0.0, **base}, dry, others)
    else:
        needed = needed + base["M"] * k.a + base["B_a"] * k.v

    def arrives(f):
        """What is left of a force, behind the drive and friction by load."""
        if "torque_fade" in groups:
            f = f / (1.0 + groups["torque_fade"]["c_t"] * k.time)
        droop = groups.get("force_droop", {})
        f = f * (1.0 / np.sqrt(1.0 + 2.0 * droop.get("c_q", 0.0) * f**2)
                 - droop.get("c_f", 0.0) * np.abs(f))  # fmt: skip
        return f - sum(law(f, k, groups[name]) for name, law in LOAD_LAWS.items() if name in groups)

    if not groups.keys().isdisjoint(("torque_fade", "force_droop", *LOAD_LAWS)):
        needed = force_for(arrives, needed, k)
    return missing(k, force - needed)


def held_out(values, recording):
    """rms of `lacking`; not a number for an effect that is not known here."""
    try:
        return lacking(values, recording)
    except (Unknown, KeyError):
        return np.nan
