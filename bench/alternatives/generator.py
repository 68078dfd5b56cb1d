"""Machines whose laws are not the catalogue's to the letter, simulated without the simulator of the project.

One integrator for all: Runge-Kutta of the fourth order with a fixed step of 50 us, vectorised over
machines, without events. Dry friction is a steep tanh of the speed (or a bristle with a state), so it
creeps where the project's would stick. A machine has one mass, or a motor and a load with a spring and
a gap between them. The drive ramps from one demand to the next within a sample, and the recorded force
is what it has at the instants of the samples. Forces in N, positive in the direction of the position.
"""
import dataclasses

import numpy as np
from scipy import signal

RATE = 500  # samples per second
STEPS = 40  # integration steps per sample, 50 us each
Y, V, MOTOR_Y, MOTOR_V, LAGGED, BRISTLE = range(6)  # the state


@dataclasses.dataclass
class Machine:
    """What moves, and everything that acts on it. Zero is absence."""

    mass: float = 12.0  # kg, of motor and load together
    viscous: float = 40.0  # N s/m
    coulomb: float = 9.0  # N
    offset: float = 0.0  # N, acts on the load
    creep: float = 1e-4  # m/s, in which dry friction turns round
    # Friction beyond that
    stribeck: float = 0.0  # N, more of it at low speed
    stribeck_speed: float = 0.1  # m/s
    stribeck_exponent: float = 2.0
    drag: float = 0.0  # N at 1 m/s
    drag_exponent: float = 1.8
    directional: float = 0.0  # N s/m, more in the positive direction, less in the other
    stroke_friction: float = 0.0  # N, more towards one end: tanh((y - stroke_at) / stroke_width)
    stroke_at: float = 0.1  # m
    stroke_width: float = 0.15  # m
    bump: float = 0.0  # N, raised cosine about bump_at
    bump_at: float = 0.05  # m
    bump_width: float = 0.05  # m
    load: float = 0.0  # of the drive force, as friction
    bristle: float = 0.0  # m, over which dry friction builds up after a reversal (LuGre)
    warming: float = 0.0  # part of the dry friction that goes away with time
    warming_time: float = 3.0  # s
    # Forces along the stroke
    spring: float = 0.0  # N/m, stiffening
    spring_length: float = 0.4  # m, at which it is twice as stiff
    ripple: float = 0.0  # N
    ripple_period: float = 0.03  # m
    ripple_phase: float = 0.0
    # Drive
    saturation: float = 0.0  # 1/N: force S tanh(F / S), this is 1 / S
    fade: float = 0.0  # part of the force that is lost, with fade_time
    fade_time: float = 5.0  # s
    lag: float = 0.0  # s
    dead_time: float = 0.0  # s
    # Two masses
    motor_share: float = 0.0  # of the mass; zero: one mass
    stiffness: float = 0.0  # N/m
    damping: float = 0.0  # N s/m
    gap: float = 0.0  # m, half of the backlash
    guided: float = 0.0  # 1: friction is on the motor's side, 0: on the load's
    # What nobody models
    disturbance: float = 0.0  # N rms, coloured
    disturbance_corner: float = 3.0  # Hz


@dataclasses.dataclass
class Motion:
    """How a machine is driven. `kind` is "servo" (a drive that follows `demand`, rows of position,
    velocity and acceleration) or "levels" (`demand` is the force in N)."""

    kind: str
    demand: np.ndarray
    seed: int = 0  # of the disturbance
    bandwidth: float = 25.0  # rad/s, of the servo
    most: float = 1e9  # N


def moves(rng, samples, stroke=0.25, least=0.3, most=0.9, rest=0.3):
    """Position, velocity and acceleration of moves to random places, each half a cosine."""
    time = np.arange(samples) / RATE
    path = np.zeros((3, samples))
    begin, place = 0.05, 0.0
    while begin < time[-1]:
        lasts, to = rng.uniform(least, most), rng.uniform(-stroke, stroke)
        if abs(to - place) < 0.3 * stroke:
            continue
        w, half = np.pi / lasts, 0.5 * (to - place)
        q = w * (time - begin)
        inside = (q >= 0.0) & (q < np.pi)
        path[:, inside] = np.stack([place + half * (1.0 - np.cos(q)), half * w * np.sin(q),
                                    half * w * w * np.cos(q)])[:, inside]  # fmt: skip
        path[0, time >= begin + lasts] = to
        place = to
        begin += lasts + (rng.uniform(0.05, 0.2) if rng.random() < rest else 0.0)
    return path


def sines(rng, samples, stroke=0.2, parts=3):
    """Position, velocity and acceleration of a sum of sines that begins at rest."""
    time = np.arange(samples) / RATE
    frequency, phase = rng.uniform(0.15, 1.0, parts), rng.uniform(0.0, 2 * np.pi, parts)
    size = rng.uniform(0.5, 1.0, parts) / frequency
    size *= stroke / np.sum(size)
    w = 2 * np.pi * frequency[:, None]
    path = np.sum(size[:, None] * np.sin(w * time + phase[:, None]), 0)
    fade_in = np.clip(time / 0.5, 0.0, 1.0)
    path = path * fade_in**3 * (10.0 - 15.0 * fade_in + 6.0 * fade_in**2)
    speed = np.gradient(path, 1.0 / RATE)
    return np.stack([path, speed, np.gradient(speed, 1.0 / RATE)])


def levels(rng, samples, force, least=0.1, most=0.45):
    """Forces of alternating sign and random size, each held for a while, with ramps of 20 ms."""
    values, at, sign = np.zeros(samples), 0, rng.choice((-1.0, 1.0))
    while at < samples:
        length = int(RATE * rng.uniform(least, most))
        values[at : at + length] = sign * force * rng.uniform(0.3, 1.0)
        at, sign = at + length, -sign
    return signal.lfilter(np.ones(10) / 10, 1.0, values)


def coloured(seed, samples, corner):
    """Noise of unit variance behind a low-pass of the second order."""
    noise = np.random.default_rng(seed).standard_normal(samples + 4 * RATE)
    noise = signal.sosfilt(signal.butter(2, corner, fs=RATE, output="sos"), noise)[4 * RATE :]
    return noise / np.std(noise)


class Laws:
    """The parameters of many machines, as arrays, and the rate of their states. Laws that no machine
    has are left out, and masks of 0 and 1 choose: a branch for each machine would take most of the time."""

    def __init__(self, machines):
        for field in dataclasses.fields(Machine):
            setattr(self, field.name, np.array([getattr(m, field.name) for m in machines], float))
        self.two = (self.motor_share > 0.0) * 1.0
        self.motor_mass = np.where(self.two, self.motor_share, 1.0) * self.mass
        self.per_load = 1.0 / (np.where(self.two, 1.0 - self.motor_share, 1.0) * self.mass)
        self.is_lagged, self.has_bristle = (self.lag > 0.0) * 1.0, (self.bristle > 0.0) * 1.0
        self.saturates = (self.saturation > 0.0) * 1.0
        # One over what may be zero, for machines without the law.
        over = lambda x: 1.0 / np.where(x > 0.0, x, 1.0)
        self.per_lag, self.per_bristle, self.limit = map(
            over, (self.lag, self.bristle, self.saturation))  # fmt: skip
        self.used = {name: bool(np.any(getattr(self, name))) for name in vars(self)}

    def drive(self, t, force):
        """The force that arrives of one that the drive has."""
        if self.used["saturation"]:
            force = force + self.saturates * (self.limit * np.tanh(force / self.limit) - force)
        if self.used["fade"]:
            force = force * (1.0 - self.fade * (1.0 - np.exp(-t / self.fade_time)))
        return force

    def dry(self, t, y, speed, force):
        """The level of dry friction."""
        level = self.coulomb
        if self.used["warming"]:
            level = level * (1.0 - self.warming * (1.0 - np.exp(-t / self.warming_time)))
        if self.used["stribeck"]:
            level = level + self.stribeck * np.exp(
                -((speed / self.stribeck_speed) ** self.stribeck_exponent))  # fmt: skip
        if self.used["stroke_friction"]:
            level = level + self.stroke_friction * np.tanh((y - self.stroke_at) / self.stroke_width)
        if self.used["bump"]:
            q = np.minimum(np.abs(y - self.bump_at) / self.bump_width, 1.0)
            level = level + self.bump * 0.5 * (1.0 + np.cos(np.pi * q))
        if self.used["load"]:
            level = level + self.load * np.sqrt(force * force + 1.0)
        return level

    def stroke(self, y):
        """Forces that depend on the place."""
        total = self.offset
        if self.used["spring"]:
            total = total - self.spring * y * (1.0 + (y / self.spring_length) ** 2)
        if self.used["ripple"]:
            q = 2 * np.pi / self.ripple_period * y + self.ripple_phase
            total = total + self.ripple * np.tanh(2.0 * np.sin(q))
        return total

    def rate(self, t, state, ramp, disturbance):
        y, v = state[Y], state[V]
        rate = np.zeros_like(state)
        force = ramp
        if self.used["lag"]:
            rate[LAGGED] = self.is_lagged * (ramp - state[LAGGED]) * self.per_lag
            force = ramp + self.is_lagged * (state[LAGGED] - ramp)
        force = self.drive(t, force)
        on_load = force
        if self.used["motor_share"]:
            twist = state[MOTOR_Y] - y
            beyond = twist - np.minimum(np.maximum(twist, -self.gap), self.gap)
            touch = (beyond != 0.0) * self.damping
            coupling = self.stiffness * beyond + touch * (state[MOTOR_V] - v)
            on_load = force + self.two * (coupling - force)
        rubs = v
        if self.used["guided"]:
            rubs = v + self.guided * (state[MOTOR_V] - v)
        sliding = turned = np.tanh(rubs / self.creep)
        speed = np.abs(rubs)
        if self.used["bristle"]:
            z = state[BRISTLE] * self.per_bristle
            rate[BRISTLE] = self.has_bristle * (rubs - speed * z)
            sliding = turned + self.has_bristle * (z - turned)
        friction = self.dry(t, y, speed, force) * sliding + self.viscous * rubs
        if self.used["directional"]:
            friction = friction + self.directional * speed
        if self.used["drag"]:
            friction = friction + self.drag * speed**self.drag_exponent * turned
        on_motor = self.guided * friction
        acceleration = (on_load - (friction - on_motor) + self.stroke(y) + disturbance) * self.per_load
        rate[Y], rate[V] = v, acceleration
        rate[MOTOR_Y], rate[MOTOR_V] = v, acceleration
        if self.used["motor_share"]:
            rate[MOTOR_Y] += self.two * (state[MOTOR_V] - v)
            rate[MOTOR_V] += self.two * ((force - on_load - on_motor) / self.motor_mass - acceleration)
        return rate


class Drive:
    """The forces of many motions, sample by sample."""

    def __init__(self, machines, motions):
        self.mass = np.array([m.mass for m in machines])
        self.offset = np.array([m.offset for m in machines])
        self.is_servo = np.array([m.kind == "servo" for m in motions])
        self.most = np.array([m.most for m in motions])
        self.bandwidth = np.array([m.bandwidth for m in motions])
        rest = np.zeros((3, motions[0].demand.shape[-1]))
        self.path = np.stack([m.demand if m.kind == "servo" else rest for m in motions], -1)
        self.force = np.stack([m.demand if m.kind == "levels" else rest[0] for m in motions], -1)

    def demand(self, k, y, v):
        at, speed, acceleration = self.path[:, k]
        w = self.bandwidth
        follow = acceleration + w * w * (at - y) + 2.0 * w * (speed - v)
        servo = np.clip(self.mass * follow - self.offset, -self.most, self.most)
        return np.where(self.is_servo, servo, self.force[k])


def simulate(machines, motions):
    """The logs of all machines, each in its motion, with the same number of samples: a list of
    dictionaries of `time`, `force`, `position`, `velocity` and `acceleration`, without noise."""
    laws, drive = Laws(machines), Drive(machines, motions)
    samples = motions[0].demand.shape[-1]
    h = 1.0 / (RATE * STEPS)
    disturbance = np.stack([m.disturbance * coloured(motion.seed, samples + 1, m.disturbance_corner)
                            for m, motion in zip(machines, motions)], -1)  # fmt: skip
    late = laws.dead_time * RATE  # in samples
    count = len(machines)
    forces = np.zeros((samples + 1, count))  # that the drive has at the instants of the samples
    every = np.arange(count)
    state = np.zeros((6, count))
    log = np.zeros((3, samples, count))

    def ramp(k, part):
        """The force that acts after a part of a sample."""
        if not laws.used["dead_time"]:
            return forces[k] + part * (forces[k + 1] - forces[k])
        at = np.maximum(k + part - late, 0.0)
        first = np.minimum(at.astype(int), k)
        part = at - first
        return (1.0 - part) * forces[first, every] + part * forces[first + 1, every]

    for k in range(samples):
        forces[k + 1] = drive.demand(k, state[MOTOR_Y], state[MOTOR_V])
        log[0, k], log[1, k] = state[MOTOR_Y], state[MOTOR_V]
        push, change = ramp(k, 0.0), disturbance[k + 1] - disturbance[k]
        for step in range(STEPS):
            t = k / RATE + step * h
            shake = disturbance[k] + (step + 0.5) / STEPS * change
            halfway, after = ramp(k, (step + 0.5) / STEPS), ramp(k, (step + 1.0) / STEPS)
            a = laws.rate(t, state, push, shake)
            b = laws.rate(t + 0.5 * h, state + 0.5 * h * a, halfway, shake)
            c = laws.rate(t + 0.5 * h, state + 0.5 * h * b, halfway, shake)
            d = laws.rate(t + h, state + h * c, after, shake)
            push = after
            if step == 0:
                log[2, k] = a[MOTOR_V]
            state = state + h / 6.0 * (a + 2.0 * (b + c) + d)
    time = np.arange(samples) / RATE
    return [{"time": time, "force": forces[:-1, i], "position": log[0, :, i],
             "velocity": log[1, :, i], "acceleration": log[2, :, i]} for i in every]  # fmt: skip
