"""The alternatives: sparse regression of the drive force, as in IDIM-LS of robotics and in SINDy.

    drive force = M a + B_a v + F_c sgn v - F_0 + candidate terms

Derivatives come from a zero-phase Butterworth filter and differences; then drive force and terms go
through the same second low-pass, and one sample in so many is kept (parallel filtering). The sign of
the speed runs straight through zero within its noise. The base terms that the axis file declares are
always in. The candidate terms are those of the catalogue, with shapes on a grid; each carries the name
of its effect. A method gives the terms that it selects:

- `stlsq`: sequentially thresholded ridge regression of all terms (SINDy with control), and least
  squares of those that are left; threshold, in N rms of a term, and ridge are those with the smallest
  error on the recording to validate.
- `bic`: forward selection, one term at a time, while Schwarz's criterion falls.
- `lasso`: scikit-learn's LassoCV with its five folds, after projection off the base terms; the terms
  that it keeps are then fitted by least squares.
"""
import dataclasses

import numpy as np
from scipy import interpolate, signal
from sklearn.linear_model import LassoCV

CUTOFF = 60.0  # Hz, of the derivatives
BAND = 20.0  # Hz, in which forces are compared
RIDGES = (1e-4, 1e-2)  # of stlsq, beside terms of unit size
LEAST_SPEED = 0.01  # of the largest, at which an axis moves
EDGE = 0.15  # s, at either end, where filters start
MOST = 3.0  # times the largest recorded force: no force is predicted beyond
NAMES = {"M": "a", "B_a": "v", "F_c": "sgn v", "F_0": "1"}  # base terms


@dataclasses.dataclass
class Kinematics:
    """Signals of a recording at an even rate, filtered unless they are exact, and the force as recorded."""

    time: np.ndarray
    force: np.ndarray
    y: np.ndarray
    v: np.ndarray
    a: np.ndarray
    direction: np.ndarray

    @property
    def rate(self):
        return 1.0 / (self.time[1] - self.time[0])

    @property
    def moves(self):
        """Where it does: at rest the friction is what the drive makes it."""
        return np.abs(self.v) > LEAST_SPEED * np.max(np.abs(self.v))


def low_pass(values, corner, rate):
    sections = signal.butter(4, min(corner, 0.45 * rate), fs=rate, output="sos")
    return signal.sosfiltfilt(sections, values, axis=0)


def slope(time, values):
    """Derivative of the spline of the fifth order through the values: differences of 2 ms are 1 % off
    at 20 Hz, which looks like a part on a spring."""
    return interpolate.make_interp_spline(time, values, k=5).derivative()(time)


def kinematics(recording, cutoff=CUTOFF):
    """Position, velocity and acceleration from what is recorded of them."""
    step = recording.time[1] - recording.time[0]
    if recording.acceleration is not None:
        return Kinematics(recording.time, recording.force, recording.position, recording.velocity,
                          recording.acceleration, np.sign(recording.velocity))  # fmt: skip
    if recording.velocity is not None:
        v = low_pass(recording.velocity, cutoff, 1.0 / step)
        y = np.concatenate([[0.0], np.cumsum(0.5 * step * (v[1:] + v[:-1]))])
    else:
        y = low_pass(recording.position, cutoff, 1.0 / step)
        v = slope(recording.time, y)
    # Within the noise of the speed its sign is not known.
    measured = recording.velocity if recording.velocity is not None else np.gradient(
        recording.position, step)  # fmt: skip
    noise = np.std(measured - v) * np.sqrt(2.0 * cutoff * step)
    return Kinematics(recording.time, recording.force, y, v, slope(recording.time, v),
                      np.clip(v / max(3.0 * noise, 1e-3 * np.max(np.abs(v))), -1.0, 1.0))  # fmt: skip


def compared(values, rate):
    """Values in the band in which forces are compared, without the edges and decimated."""
    edge, keep = int(EDGE * rate), max(1, int(rate / (3.0 * BAND)))
    return low_pass(values, BAND, rate)[edge:-edge:keep]


def missing(k, force):
    """rms in N of a force that a model lacks where the axis moves, in the band in which forces are compared."""
    return float(np.sqrt(np.mean(compared(np.where(k.moves, force, 0.0), k.rate) ** 2)))


def force_for(response, wanted, k):
    """The smallest force in N that makes what is wanted of `response`, which is 0 at no force and of the sign
    of the force; where none does up to MOST, the one that comes nearest. Sample by sample."""
    to = np.sign(wanted)
    nearest, reached, before = np.zeros_like(wanted), np.zeros_like(wanted), np.zeros_like(wanted)
    most = MOST * np.max(np.abs(k.force))
    step = most / 300
    for force in np.arange(step, most, step):
        now, open_ = to * response(to * force), reached < np.abs(wanted)
        rises = open_ & (now > reached)
        part = (np.abs(wanted) - before) / np.where(rises, now - before, 1.0)
        nearest = np.where(rises, force - step + step * np.clip(part, 0.0, 1.0), nearest)
        reached, before = np.where(rises, now, reached), now
    return to * nearest


def hysteresis(k, length):
    """Friction that builds up over `length` after a reversal, of level one."""
    z, state = np.zeros_like(k.y), 0.0
    for i, moved in enumerate(np.diff(k.y), 1):
        to = np.sign(moved)
        state = to - (to - state) * np.exp(-abs(moved) / length)
        z[i] = state
    return z


# Terms of the force itself: what they take of it.
LOSSES = {
    "load_friction": ("|F| sgn v", lambda f, k: np.abs(f) * k.direction),
    "torque_fade": ("F t", lambda f, k: f * k.time),
    "force_droop": ("F|F|", lambda f, k: f * np.abs(f)),
}


def base_terms(k):
    return {"M": k.a, "B_a": k.v, "F_c": k.direction, "F_0": -np.ones_like(k.v)}


@dataclasses.dataclass
class Scales:
    """What the grids span, from the recording that is fitted."""

    speed: float
    low: float
    high: float
    interval: float


def scales(k):
    return Scales(np.max(np.abs(k.v)), np.min(k.y), np.max(k.y), 1.0 / k.rate)


def candidate_terms(k, s, declared):
    """(effect, term, values) of the catalogue's effects for a force source with one mass."""
    v, y, sgn, f, t = k.v, k.y, k.direction, k.force, k.time
    base = base_terms(k)
    effects = {"M": "added_mass", "F_c": "coulomb_friction", "F_0": "constant_force"}
    terms = [(effects[q], NAMES[q], base[q]) for q in effects if q not in declared]
    stroke, middle = s.high - s.low, 0.5 * (s.high + s.low)
    x = (y - middle) / (0.5 * stroke)
    terms += [("quadratic_drag", "v|v|", v * np.abs(v)), ("directional_friction", "|v|", np.abs(v)),
              ("stroke_spring", "x", x), ("position_friction", "x sgn v", x * sgn),
              ("position_friction", "x^2 sgn v", x * x * sgn), ("position_friction", "x v", x * v),
              ("warming_friction", "t sgn v", t * sgn)]  # fmt: skip
    terms += [(effect, term, loss(f, k)) for effect, (term, loss) in LOSSES.items()]
    smooth = low_pass(f, CUTOFF, k.rate)
    terms.append(("drive_lag", "dF/dt", slope(t, smooth)))
    terms.append(("elastic_mode", "d2a/dt2", slope(t, slope(t, k.a))))
    for part in (0.01, 0.03, 0.1, 0.3):
        terms.append(("stribeck_friction", f"exp(-|v|/{part * s.speed:.3g}) sgn v",
                      np.exp(-np.abs(v) / (part * s.speed)) * sgn))  # fmt: skip
    for length in (1e-4, 1e-3, 1e-2):
        terms.append(("dahl_friction", f"z({length:g} m)", hysteresis(k, length)))
    for place in np.linspace(s.low, s.high, 10)[1:-1]:
        terms.append(("friction_bump", f"bump({place:.3g} m) sgn v",
                      np.exp(-((y - place) / (stroke / 10)) ** 2) * sgn))  # fmt: skip
    for waves in np.arange(2.0, 40.0, 0.5):
        q = 2 * np.pi * waves * y / stroke
        terms.append(("periodic_force", f"sin(2 pi x / {stroke / waves:.4g} m)", np.sin(q)))
        terms.append(("periodic_force", f"cos(2 pi x / {stroke / waves:.4g} m)", np.cos(q)))
    return terms


class Problem:
    """Force and terms of a recording to fit and of another to validate, filtered and decimated."""

    def __init__(self, fit, validate, declared, mass=0.0):
        """With the base terms that are fitted, and a mass in kg that is taken for known."""
        self.declared = declared
        self.mass = 0.0 if "M" in declared else mass
        self.scales = scales(fit)
        self.effects = []
        self.force, self.base, self.terms = zip(*(self.filtered(k) for k in (fit, validate)))

    def columns(self, k):
        """The force less that of the known mass, the base terms and the candidate terms."""
        terms = candidate_terms(k, self.scales, self.declared)
        self.effects = [effect for effect, _, _ in terms]
        base = base_terms(k)
        force = k.force - self.mass * k.a
        return np.stack([force, *(base[q] for q in self.declared), *(c for *_, c in terms)], -1)

    def filtered(self, k):
        columns = compared(self.columns(k), k.rate)
        split = 1 + len(self.declared)
        return columns[:, 0], columns[:, 1:split], columns[:, split:]

    def solve(self, selected, part=0):
        """Coefficients of the base terms and of the selected ones, by least squares."""
        columns = np.column_stack([self.base[part], self.terms[part][:, selected]])
        size = np.sqrt(np.mean(columns**2, 0))
        return np.linalg.lstsq(columns / size, self.force[part], rcond=1e-8)[0] / size

    def error(self, selected, coefficients, part):
        columns = np.column_stack([self.base[part], self.terms[part][:, selected]])
        return np.sqrt(np.mean((self.force[part] - columns @ coefficients) ** 2))


def thresholded(p, threshold, ridge):
    """The terms that are left of all when those below the threshold go, again and again."""
    force, terms = off_base(p)
    size, n = np.sqrt(np.mean(terms**2, 0)), len(force)
    selected = np.flatnonzero(size > 1e-6 * np.sqrt(np.mean(p.terms[0] ** 2, 0)))
    while len(selected):
        x = terms[:, selected] / size[selected]
        coefficients = np.linalg.solve(x.T @ x + ridge * n * np.eye(len(selected)), x.T @ force)
        keep = np.abs(coefficients) >= threshold
        if np.all(keep):
            break
        selected = selected[keep]
    return list(selected)


def stlsq(p):
    best = (np.inf, [])
    most = np.sqrt(np.mean(off_base(p)[0] ** 2))
    for ridge in RIDGES:
        for threshold in most * np.geomspace(1e-3, 1.0, 25):
            selected = thresholded(p, threshold, ridge)
            best = min(best, (p.error(selected, p.solve(selected), 1), selected))
    return best[1]


def off_base(p):
    """Force and terms of the fitted recording less their projections on the base terms."""
    q = np.linalg.qr(p.base[0])[0]
    return p.force[0] - q @ (q.T @ p.force[0]), p.terms[0] - q @ (q.T @ p.terms[0])


def bic(p):
    force, terms = off_base(p)
    n, size = len(force), np.sqrt(np.sum(terms**2, 0))
    smallest, selected = 1e-6 * size, []
    squares = np.sum(force**2)
    while len(selected) < 30:
        norm = np.sqrt(np.sum(terms**2, 0))
        gain = np.where(norm > smallest, (terms.T @ force / np.maximum(norm, 1e-300)) ** 2, 0.0)
        best = int(np.argmax(gain))
        if n * np.log(squares / (squares - gain[best])) < np.log(n):
            break
        selected.append(best)
        direction = terms[:, best] / norm[best]
        force = force - direction * (direction @ force)
        terms = terms - np.outer(direction, direction @ terms)
        squares = np.sum(force**2)
    return selected


def lasso(p):
    force, terms = off_base(p)
    size = np.std(terms, 0)
    fit = LassoCV(cv=5, max_iter=5000).fit(terms / size, force)
    return list(np.flatnonzero(fit.coef_))


METHODS = {"stlsq": stlsq, "bic": bic, "lasso": lasso}


def held_out(p, selected, k):
    """rms in N of the force that a selection lacks in a recording that it has not seen: the force less the one
    that it predicts for the motion. A term of the force itself must not explain the force by itself."""
    columns, split = p.columns(k), 1 + len(p.declared)
    of_base, own = np.split(p.solve(selected), [split - 1])
    needed, taken = p.mass * k.a + columns[:, 1:split] @ of_base, []
    for c, i in zip(own, selected):
        if p.effects[i] in LOSSES:
            taken.append((c, LOSSES[p.effects[i]][1]))
        else:
            needed = needed + c * columns[:, split + i]
    if taken:
        needed = force_for(lambda f: f - sum(c * loss(f, k) for c, loss in taken), needed, k)
    return missing(k, k.force - needed)
