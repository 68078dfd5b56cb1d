"""Recordings of simulated machines, made without the simulator of the project. `simulate`: a mass that a
motor drives against viscous and Coulomb friction and perhaps a weight, at a current that holds for a
sample, so that every sample has a closed solution, in two parts where the mass stops in it. `move`: a mass or
joint with gravity, a spring or a stop, in short steps of constant force, each of them closed in the same way.
Read by first_contact.py."""
import dataclasses
import math

import numpy as np

SAMPLE = 1e-3  # s


@dataclasses.dataclass
class Machine:
    """A mass and what drives it. `control` is "current" (a current that is commanded) or "velocity"
    (a PI controller that makes the current)."""

    mass: float = 12.0  # kg
    viscous: float = 30.0  # N s/m
    coulomb: float = 8.0  # N
    weight: float = 0.0  # N, against the motion
    gain: float = 6.5  # N/A
    control: str = "current"
    demand: np.ndarray = None  # A or m/s, one value a sample

    @property
    def truth(self):
        return {"M": self.mass, "B_a": self.viscous, "coulomb_friction.F_c": self.coulomb,
                "constant_force.F_0": -self.weight}  # fmt: skip


@dataclasses.dataclass
class Axis:
    """A mass (kg, N) or a joint (kg m^2, N m), or either in volts. `control` makes the input of demand, place
    and speed, once a sample. With a stiffness the demand is the place of the motor, and the input that is
    recorded is the torque of the spring behind it."""

    inertia: float
    viscous: float
    coulomb: float
    demand: np.ndarray  # one value a sample
    control: object = lambda demand, q, v: demand
    gain: float = 1.0
    constant: float = 0.0  # force or torque that acts beside the motor's
    sine: float = 0.0  # of gravity, against the motion
    cosine: float = 0.0
    stop: float = math.inf
    start: float = 0.0
    stiffness: float = 0.0
    turns: bool = True
    sample: float = SAMPLE

    @property
    def truth(self):
        if not self.turns:
            return {"M": self.inertia, "B_a": self.viscous, "coulomb_friction.F_c": self.coulomb,
                    "constant_force.F_0": self.constant}  # fmt: skip
        return {"J": self.inertia, "B_a": self.viscous, "coulomb_friction.T_c": self.coulomb,
                "constant_torque.T_0": self.constant, "pendulum_gravity.G_s": self.sine,
                "pendulum_gravity.G_c": self.cosine}  # fmt: skip


@dataclasses.dataclass
class Motion:
    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    current: np.ndarray
    demand: np.ndarray


def levels(rng, amplitude, seconds, hold=0.35, mean=0.0):
    """Random levels, each held for about `hold` s, with ramps of 20 ms between them."""
    n = int(seconds * 1000)
    values, t = np.zeros(n), 0
    sign = 1
    while t < n:
        length = int(1000 * hold * rng.uniform(0.5, 1.5))
        values[t : t + length] = mean + sign * amplitude * rng.uniform(0.35, 1.0)
        sign, t = -sign, t + length
    return np.convolve(np.pad(values, 10, mode="edge"), np.ones(20) / 20, mode="same")[10:-10]


def part(y, v, force, direction, time, mass, viscous, coulomb):
    """Position and velocity after a time in which friction acts against one direction; zero: at
    rest."""
    limit = np.where(direction == 0.0, 0.0, (force - direction * coulomb) / viscous)
    start = np.where(direction == 0.0, 0.0, v)
    decay = np.exp(-viscous / mass * time)
    y = y + limit * time + (start - limit) * mass / viscous * (1.0 - decay)
    return y, limit + (start - limit) * decay


def simulate(machines):
    """The motions of machines whose demands are equally long, all at once."""
    of = lambda name: np.array([getattr(m, name) for m in machines], dtype=float)
    mass, viscous, coulomb, weight, gain = map(of, ("mass", "viscous", "coulomb", "weight", "gain"))
    laws = mass, viscous, coulomb
    is_loop = np.array([m.control == "velocity" for m in machines])
    demand = np.array([m.demand for m in machines])
    samples = demand.shape[1]
    v, y, integral = (np.zeros(len(machines)) for _ in range(3))
    out = np.zeros((4, len(machines), samples))
    for k in range(samples):
        # The controller of a velocity loop runs once a sample.
        error = demand[:, k] - v
        integral = np.where(is_loop, integral + error * SAMPLE, 0.0)
        loop = np.clip((40.0 * mass * error + 600.0 * mass * integral) / gain, -12.0, 12.0)
        current = np.where(is_loop, loop, demand[:, k])
        out[:, :, k] = y, v, current, demand[:, k]
        force = gain * current - weight
        breaks_away = np.where(np.abs(force) > coulomb, np.sign(force), 0.0)
        direction = np.where(v == 0.0, breaks_away, np.sign(v))
        limit = (force - direction * coulomb) / viscous
        _, after = part(y, v, force, direction, SAMPLE, *laws)
        stops = (v != 0.0) & (after * v <= 0.0)
        with np.errstate(all="ignore"):
            until = np.where(stops, mass / viscous * np.log1p(-v / limit), SAMPLE)
        y, v = part(y, v, force, direction, until, *laws)
        v = np.where(stops, 0.0, v)
        y, v = (np.where(stops, a, b)
                for a, b in zip(part(y, v, force, breaks_away, SAMPLE - until, *laws), (y, v)))
    time = np.arange(samples) * SAMPLE
    return [Motion(time, *out[:, i]) for i in range(len(machines))]


def waves(rng, amplitude, seconds, rate, sample=SAMPLE):
    """Three sines of drawn strengths and frequencies about `rate`, which begin gently."""
    t = np.arange(round(seconds / sample)) * sample
    angles = [2.0 * math.pi * rate * k * rng.uniform(0.85, 1.15) * t for k in (0.43, 1.0, 2.3)]
    parts = [rng.uniform(0.5, 1.0) * np.sin(angle + rng.uniform(0.0, 6.0)) for angle in angles]
    return amplitude / 2.0 * sum(parts) * (1.0 - np.exp(-((t * rate) ** 2)))


def speed_loop(p, i, limit, sample=SAMPLE):
    integral = 0.0

    def control(demand, _, v):
        nonlocal integral
        integral += (demand - v) * sample
        return min(limit, max(-limit, p * (demand - v) + i * integral))

    return control


def place_loop(p, d, limit):
    return lambda demand, q, v: min(limit, max(-limit, p * (demand - q) - d * v))


def flow(axis, q, v, force, left):
    """Place and speed after a time at one force; friction stops it and holds it within the time. The series
    are those of exponentials, and exact without viscous friction, too."""
    growth = lambda x: 1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0))
    while left > 0.0:
        direction = math.copysign(1.0, v or force)
        if v == 0.0 and abs(force) <= axis.coulomb:
            break
        rate = axis.viscous / axis.inertia
        a = (force - direction * axis.coulomb) / axis.inertia - rate * v
        t, stops = left, v * (v + a * left * growth(rate * left)) < 0.0
        if stops:
            t = -v / a
            for _ in range(3):
                t = -v / (a * growth(rate * t))
        x = rate * t
        q += v * t + a * t * t * (0.5 - x / 6.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0)))
        v = 0.0 if stops else v + a * t * growth(x)
        left -= t
    return q, v


def move(axis):
    steps = math.ceil(axis.sample / 2.5e-4)
    h = axis.sample / steps
    q, v = axis.start, 0.0
    rows = np.zeros((3, len(axis.demand)))
    follow = np.append(axis.demand[1:], axis.demand[-1])
    for k, (demand, then) in enumerate(zip(axis.demand, follow)):
        u = axis.stiffness * (demand - q) if axis.stiffness else axis.control(demand, q, v)
        rows[:, k] = q, v, u
        for part in range(steps):
            middle = q + 0.5 * h * v
            if axis.stiffness:
                u = axis.stiffness * (demand + (part + 0.5) / steps * (then - demand) - middle)
            gravity = axis.sine * math.sin(middle) + axis.cosine * math.cos(middle)
            q, v = flow(axis, q, v, axis.gain * u + axis.constant - gravity, h)
            if q > axis.stop:
                q, v = axis.stop, min(v, 0.0)
    return Motion(np.arange(len(axis.demand)) * axis.sample, *rows, axis.demand)
