"""Recordings of simulated machines, made without the simulator of the project: a mass that a motor
drives against viscous and Coulomb friction and perhaps a weight. The current holds for a sample, so that
every sample has a closed solution, in two parts where the mass stops in it. Read by
first_contact.py."""
import dataclasses

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
