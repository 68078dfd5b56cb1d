#!/usr/bin/python3
"""whole_fit.py [BUILD] [CALLS]: the paper's fit by axisfit, by SciPy and by lmfit.

The same recording, free parameters, first guesses and residuals for all, as in
configs/jobs/paper.yaml; the recording is made anew, of a velocity and an accelerometer that also
counts while the arm rests. SciPy integrates the same equations with LSODA and Radau; where the arm would stick its friction
runs smoothly through zero, since solve_ivp knows no modes. Jacobians are one-sided differences.
Needs python3-scipy and python3-lmfit.
"""
import csv
import json
import math
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import lmfit
import numpy
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

ROOT = pathlib.Path(__file__).resolve().parent.parent
# configs/axes/x.yaml, SI
KNOWN = {"R": 0.56, "L": 2.35e-3, "K_e": 0.289, "K_m": 0.289, "J_m": 0.000847, "B_m": 0.000733,
         "K_t": 0.0668, "r_g": 5.73e-3, "H": 1e-5, "M": 146.0, "T_z": 7.05e-3, "T_r": 0.159e-3,
         "K_1": 1014.2, "K_2": 870.0, "K_i": 3.0, "V_s": 95.0, "F_s": 30.0, "w": 2e-3,
         "K_v": 1000.0}
NAMES = ["V_L", "B_a", "b_g", "k_g", "T_p"]
START = [8.0, 60.0, 5000.0, 1.5e6, 0.1]  # as in JOB
SIGMA = {"velocity_mps": 2e-3, "acceleration_mps2": 0.05}
SMOOTH = 1e-5  # m/s, within which the friction changes its sign
TOLERANCE = 1e-6  # of the solvers, relative; differences need more than that
STEP = 1e-3  # of the differences, in the logarithm of a parameter


def held(x, limit):
    return limit if x > limit else -limit if x < -limit else x


class Rig:
    """A recording, and residuals of a simulation by solve_ivp."""

    def __init__(self, recording, solver):
        self.solver = solver
        self.simulations = 0
        self.seconds = 0.0
        with open(recording, encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.columns = {name: numpy.array([float(row[name]) for row in rows]) for name in rows[0]}
        times, command = self.columns["time_s"], self.columns["command_v"]
        switches = [0, *(numpy.flatnonzero(numpy.diff(command)) + 1), len(times) - 1]
        self.spans = [(a, b, command[a]) for a, b in zip(switches, switches[1:])]

    def equations(self, parameters, command):
        p = {**KNOWN, **parameters}
        R, L, K_e, K_m, J_m, B_m, K_t, r_g, H, M, T_z, T_r, K_1, K_2, K_i, V_s, F_s, w, K_v = (
            p[name] for name in KNOWN)
        V_L, B_a, b_g, k_g, T_p = (p[name] for name in NAMES)
        tanh = math.tanh

        def rate(_, y):
            y0, y1, y2, y3, y4, y5, y6 = y.tolist()
            x = r_g * y2 - y0
            force = 0.0
            if x > H or x < -H:
                force = (x - held(x, H)) * k_g + (r_g * y3 - y1) * b_g
            friction = F_s * tanh(y1 / SMOOTH) if -w < y1 < w else 0.0
            voltage = held(K_v * (held(y4 + T_z * y5, V_L) - y6 / K_i), V_s)
            return (y1, (force - B_a * y1 - friction) / M, y3,
                    (K_m * y6 - B_m * y3 - r_g * force) / J_m, y5,
                    (K_1 * command - K_2 * K_t * y3 - y4 - (T_p + T_r) * y5) / (T_p * T_r),
                    (voltage - R * y6 - K_e * y3) / L)

        return rate

    def residuals(self, logarithms):
        begin = time.process_time()
        parameters = dict(zip(NAMES, numpy.exp(logarithms)))
        times, y = self.columns["time_s"], numpy.zeros(7)
        velocity, acceleration = numpy.zeros(len(times)), numpy.zeros(len(times))
        scale = numpy.array([1.0, 1.0, 100.0, 100.0, 10.0, 1e3, 10.0])
        for first, last, command in self.spans:
            rate = self.equations(parameters, command)
            run = solve_ivp(rate, (times[first], times[last]), y, method=self.solver,
                            t_eval=times[first:last + 1], rtol=TOLERANCE, atol=TOLERANCE * scale)
            if not run.success:
                raise RuntimeError(run.message)
            # A reading precedes a command that switches at its instant.
            new = slice(first + 1, last + 1) if first > 0 else slice(first, last + 1)
            states = run.y[:, 1:] if first > 0 else run.y
            velocity[new] = states[1]
            acceleration[new] = [rate(0.0, state)[1] for state in states.T]
            y = run.y[:, -1]
        self.simulations += 1
        self.seconds += time.process_time() - begin
        simulated = {"velocity_mps": velocity, "acceleration_mps2": acceleration}
        return numpy.concatenate(
            [(self.columns[name] - simulated[name]) / SIGMA[name] for name in SIGMA])


MOTION = "type: levels\nlevels: [10 V, 0 V]\nhold: 1.5 s\nduration: 2.5 s\n"
JOB = """axis: {axis}
recordings:
  - name: step
    file: step.csv
    time: {{column: time_s, unit: s}}
    acceleration_at_standstill: keep
    signals:
      command: {{column: command_v, unit: V}}
      velocity: {{column: velocity_mps, unit: m/s, sigma: 2 mm/s}}
      acceleration: {{column: acceleration_mps2, unit: m/s^2, sigma: 0.05 m/s^2}}
free:
  V_L: {{initial: 8 V}}
  B_a: {{initial: 60 N s/m}}
  b_g: {{initial: 5000 N s/m}}
  k_g: {{initial: 1.5e6 N/m}}
  T_p: {{initial: 0.1 s}}
"""


def row(method, seconds, calls, chi_square, values, per_evaluation=None):
    """Prints a line of the table."""
    ms = "" if per_evaluation is None else f"{1e3 * per_evaluation:.0f}"
    print(f"{method:<27} {seconds:>8.2f} {calls:>6} {ms:>8} {chi_square:>10.4g}"
          + "".join(f" {value:>9.4g}" for value in values), flush=True)


def by_axisfit(apps, folder):
    """Writes motion and job, records and fits; the processor time of the fit, and its result."""
    axis = ROOT / "configs" / "axes" / "x.yaml"
    (folder / "motion.yaml").write_text(MOTION, encoding="utf-8")
    (folder / "job.yaml").write_text(JOB.format(axis=axis), encoding="utf-8")
    subprocess.run([apps / "simulate-axis", axis, folder / "motion.yaml", "--output",
                    folder / "step.csv"], check=True)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    result = subprocess.run([apps / "fit-params", folder / "job.yaml", "--threads", "1", "--json"],
                            check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return seconds, json.loads(result.stdout)


def by_scipy(rig, calls):
    """Calls and logarithms of the parameters."""
    fit = least_squares(rig.residuals, numpy.log(START), diff_step=STEP, max_nfev=calls)
    return fit.nfev, fit.x


def by_lmfit(rig, calls):
    """Calls and logarithms of the parameters."""
    start = lmfit.Parameters()
    for name, value in zip(NAMES, START):
        start.add(name, value=math.log(value))
    fit = lmfit.minimize(lambda p: rig.residuals([p[name].value for name in NAMES]), start,
                         method="leastsq", epsfcn=STEP**2, max_nfev=calls * (len(NAMES) + 1))
    return fit.nfev, [fit.params[name].value for name in NAMES]


def main():
    apps = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "release") / "apps"
    calls = int(sys.argv[2]) if len(sys.argv) > 2 else 50
    print(f"{'':<27} {'s':>8} {'calls':>6} {'ms r, J':>8} {'red. chi2':>10}"
          + "".join(f" {name:>9}" for name in NAMES))
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        seconds, result = by_axisfit(apps, folder)
        values = {p["name"]: p["value"] for p in result["parameters"]}
        row("axisfit, all of fit-params", seconds, result["iterations"],
            result["reduced_chi_square"], [values[name] for name in NAMES])
        for method, fit in (("SciPy least_squares", by_scipy), ("lmfit leastsq", by_lmfit)):
            for solver in ("LSODA", "Radau"):
                rig = Rig(folder / "step.csv", solver)
                done, found = fit(rig, calls)
                seconds, simulations = rig.seconds, rig.simulations
                residuals = rig.residuals(found)
                row(f"{method}, {solver}", seconds, done,
                    numpy.sum(residuals**2) / (len(residuals) - len(NAMES)), numpy.exp(found),
                    seconds / simulations * (len(NAMES) + 1))


if __name__ == "__main__":
    main()
