"""The cases of the independent generator: machines, motions, recordings, jobs, and the truth.

A case has three recordings of different motions: `fit`, `validate`, and `test`, which no method sees
and on which all are judged. That one has neither noise nor disturbance, and its motion is known exactly,
so that its error is the model's. Half of the machines are driven by a servo with a position encoder and
fitted with an observer, as --init and the EMPS job do; the others by levels of force, with a recorded
velocity and a free run, or with the horizon that `--horizon` of run.py says. All but the clean ones
with white noise may have a coloured disturbance too.

The strength of a law is such that the reduced chi-square of the best fit without it is about 3 or 10, or
what `--chi-square` of run.py says. It is found without the project: the force that the base model lacks,
sent through the linear response of the axis (with its observer), less its projection on the responses of the
base terms.
"""
import dataclasses
import json
import zlib

import numpy as np
from scipy import signal

from generator import RATE, Machine, Motion, levels, moves, simulate, sines
from kinds import KINDS, PAIRS, SEVERAL

ROLES = ("fit", "validate", "test")
CLEAN = ("clean_white", "clean_coloured")
NAMES = (*(k for k in KINDS if k != "disturbance"), "pair", "several", *CLEAN)
ROUNDS = 3  # of the calibration
SECONDS = 5


@dataclasses.dataclass
class Recording:
    time: np.ndarray
    force: np.ndarray
    position: np.ndarray = None
    velocity: np.ndarray = None
    acceleration: np.ndarray = None  # of `test` alone, whose motion is known exactly: all three are given


@dataclasses.dataclass
class Case:
    name: str
    chi_square: float  # aimed at, of each law by itself
    setup: str
    base: Machine
    parts: list  # names of laws that the axis file does not have
    shapes: dict
    force: float  # N, the scale
    sigma: float  # of position or velocity, SI
    sigma_force: float
    motions: dict
    strengths: dict = dataclasses.field(default_factory=dict)
    disturbance: float = 1.0  # chi-square of it alone
    recordings: dict = None

    @property
    def secrets(self):
        return {KINDS[p].secret for p in self.parts} - {""}

    @property
    def free(self):
        """The base terms that are declared and fitted."""
        return [q for q in ("M", "B_a", "F_c", "F_0") if q not in self.secrets]

    @property
    def observer(self):
        """rad/s: a missing hundredth of the acceleration shows as much as the noise."""
        return float(f"{np.sqrt(0.01 * 0.4 * self.force / self.base.mass / self.sigma):.2g}")

    def machine(self, *laws):
        """The base machine with some of the laws."""
        m = self.base
        for law in laws:
            fields = KINDS[law].law(m, self.strengths[law], self.shapes[law], self.force)
            m = dataclasses.replace(m, **fields)
        return m


def draw(name, index, seed, chi_squares):
    """A case, the same for every list of cases that it is in."""
    code = zlib.crc32(name.encode())
    rng = np.random.default_rng([seed, code, index])
    order = index + code  # so that one case of each kind has all combinations
    mass = np.exp(rng.uniform(np.log(5.0), np.log(60.0)))
    force = 8.0 * mass
    if name == "pair":
        parts = list(PAIRS[index % len(PAIRS)])
    elif name == "several":
        parts = list(SEVERAL)
    else:
        parts = [] if name in CLEAN else [name]
    allowed = set.intersection({"servo", "levels"}, *(KINDS[p].setups for p in parts))
    setup = ("servo", "levels")[order % 2] if len(allowed) > 1 else allowed.pop()
    base = Machine(mass=mass, viscous=mass * rng.uniform(1.5, 4.0),
                   coulomb=force * rng.uniform(0.04, 0.12), offset=force * rng.uniform(-0.03, 0.03),
                   disturbance_corner=KINDS["disturbance"].law(None, 0, [rng.random()], 0)[
                       "disturbance_corner"])  # fmt: skip
    secrets = {KINDS[p].secret for p in parts}
    base = dataclasses.replace(base, **({"coulomb": 0.0} if "F_c" in secrets else {}),
                               **({"offset": 0.0} if "F_0" in secrets else {}))  # fmt: skip
    samples = RATE * SECONDS
    motions = {}
    for role in ROLES:
        if setup == "levels":
            least, most = (0.08, 0.3) if role == "test" else (0.1, 0.45)
            demand = levels(rng, samples, force * rng.uniform(0.7, 1.0), least, most)
        elif role == "test":
            demand = sines(rng, samples)
        else:
            demand = moves(rng, samples, rng.uniform(0.18, 0.25), 0.3, rng.uniform(0.7, 1.2))
        motions[role] = Motion(setup, demand, int(rng.integers(1 << 31)), rng.uniform(15.0, 30.0),
                               3.0 * force)  # fmt: skip
    aim = chi_squares[order // 2 % len(chi_squares)]
    case = Case(name, aim if name != "several" else 2.0 / 3.0 * chi_squares[0], setup, base, parts,
                {p: rng.random(3) for p in (*parts, "disturbance")}, force,
                between(rng, 2e-6, 5e-6) if setup == "servo" else between(rng, 3e-3, 8e-3),
                force * between(rng, 0.001, 0.005), motions)  # fmt: skip
    case.strengths = {p: KINDS[p].start * (force if KINDS[p].is_force else 1.0)
                      for p in (*parts, "disturbance")}  # fmt: skip
    if name == "clean_coloured":
        case.disturbance = between(rng, 1.3, 4.0)
    elif name != "clean_white" and rng.random() < 0.5:
        case.disturbance = rng.uniform(1.1, 1.3)
    return case


def between(rng, low, high):
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def lacking(case, log):
    """The force in N that the base model lacks in a simulated recording, with the true base."""
    m = case.base
    dry = m.coulomb * np.tanh(log["velocity"] / m.creep)
    return log["force"] + m.offset - m.mass * log["acceleration"] - m.viscous * log["velocity"] - dry


def visible(case, log):
    """Reduced chi-square, to first order, of the base model fitted to a simulated recording."""
    m = case.base
    if case.setup == "servo":
        response = signal.bilinear([1.0 / m.mass], [1.0, 2.0 * case.observer, case.observer**2], RATE)
    else:
        response = signal.bilinear([1.0 / m.mass], [1.0, m.viscous / m.mass], RATE)
    v = log["velocity"]
    terms = {"M": log["acceleration"], "B_a": v, "F_c": np.tanh(v / m.creep), "F_0": np.ones_like(v)}
    base = np.stack([signal.lfilter(*response, terms[q]) for q in case.free], -1)
    seen = signal.lfilter(*response, lacking(case, log))
    left = seen - base @ np.linalg.lstsq(base, seen, rcond=None)[0]
    return 1.0 + np.mean(left**2) / case.sigma**2


def calibrate(cases):
    """Finds the strengths, of every law and of the disturbance apart."""
    wanted = [(c, p, c.chi_square) for c in cases for p in c.parts]
    wanted += [(c, "disturbance", c.disturbance) for c in cases if c.disturbance > 1.0]
    for c in cases:
        if c.disturbance == 1.0:
            c.strengths["disturbance"] = 0.0
    for _ in range(ROUNDS):
        logs = simulate_all([(c.machine(p), c.motions["fit"]) for c, p, _ in wanted])
        for (c, p, aim), log in zip(wanted, logs):
            now = visible(c, log)
            step = ((aim - 1.0) / max(now - 1.0, 1e-12)) ** (0.5 / KINDS[p].power)
            c.strengths[p] = min(c.strengths[p] * float(np.clip(step, 0.1, 10.0)),
                                 KINDS[p].most * (c.force if KINDS[p].is_force else 1.0))


def simulate_all(pairs):
    """Logs of pairs of a machine and a motion; those that last equally long run together."""
    logs = [None] * len(pairs)
    for samples in {motion.demand.shape[-1] for _, motion in pairs}:
        chosen = [i for i, (_, motion) in enumerate(pairs) if motion.demand.shape[-1] == samples]
        for i, log in zip(chosen, simulate(*zip(*(pairs[i] for i in chosen)))):
            logs[i] = log
    return logs


def make(names, count, seed, chi_squares):
    """The cases with these names, `count` of each, with recordings."""
    cases = [draw(name, index, seed, chi_squares) for name in names for index in range(count)]
    calibrate(cases)
    laws = lambda c, role: (*c.parts, "disturbance") if role != "test" else c.parts
    pairs = [(c.machine(*laws(c, role)), c.motions[role]) for c in cases for role in ROLES]
    logs = iter(simulate_all(pairs))
    for c in cases:
        rng = np.random.default_rng([seed, zlib.crc32(c.name.encode()), c.motions["fit"].seed])
        c.recordings = {}
        for role in ROLES:
            log = next(logs)
            if role == "test":
                c.recordings[role] = Recording(**log)
                continue
            noise = rng.standard_normal((2, len(log["time"])))
            r = Recording(log["time"], log["force"] + c.sigma_force * noise[0])
            if c.setup == "servo":
                r.position = log["position"] + c.sigma * noise[1]
            else:
                r.velocity = log["velocity"] + c.sigma * noise[1]
            c.recordings[role] = r
    return cases


def write(case, folder, horizon, free_run):
    """axis.yaml, job.yaml and the two recordings that a method may see. The horizon is that of a fit
    without an observer; with `free_run` there is none for a servo, either."""
    signal_name, unit = ("position", "m") if case.setup == "servo" else ("velocity", "m/s")
    for role in ("fit", "validate"):
        r = case.recordings[role]
        table = np.column_stack([r.time, r.force, getattr(r, signal_name)])
        np.savetxt(folder / f"{role}.csv", table, "%.9g", ",", comments="",
                   header=f"time_s,force_n,{signal_name}")  # fmt: skip
    m, f = case.base, case.force
    axis = {"drive": "force_source", "transmission": "rigid",
            "parameters": {"K_f": "1 N/V", "M": f"{m.mass * ('M' in case.secrets or 0.7):.6g} kg",
                           "B_a": f"{0.5 * m.viscous:.6g} N s/m"}, "effects": {}}  # fmt: skip
    free = {q: {} for q in case.free if q in ("M", "B_a")}
    for q, effect, low in (("F_c", "coulomb_friction", 0.0), ("F_0", "constant_force", -f)):
        if q in case.free:
            axis["effects"][effect] = {q: "0 N" if q == "F_0" else f"{0.5 * m.coulomb:.6g} N"}
            free[f"{effect}.{q}"] = {"bounds": [f"{low:.6g} N", f"{f:.6g} N"]}
    job = {"axis": "axis.yaml", "free": free, "recordings": [
        {"name": role, "file": f"{role}.csv", "role": role,
         "time": {"column": "time_s", "unit": "s"},
         "signals": {"drive_force": {"column": "force_n", "unit": "N",
                                     "sigma": f"{case.sigma_force:.6g} N"},
                     signal_name: {"column": signal_name, "unit": unit,
                                   "sigma": f"{case.sigma:.6g} {unit}"}}}
        for role in ("fit", "validate")]}  # fmt: skip
    servo = {"observer": {"fixed": f"{case.observer:g} 1/s"}}
    job["fit"] = servo if case.setup == "servo" and not free_run else {"horizon": horizon}
    (folder / "axis.yaml").write_text(json.dumps(axis, indent=1) + "\n")
    (folder / "job.yaml").write_text(json.dumps(job, indent=1) + "\n")
