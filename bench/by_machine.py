#!/usr/bin/python3
"""by_machine.py [BUILD [SEEDS [MACHINE...]]]: from `fit-params --init --machine NAME` to the fit, without an edit, on
recordings of eight machines that are simulated here and not by the project: midpoint steps of 10 us, friction
that sticks, controllers that sample every millisecond, encoders that round. The gains of the drives are
those of the axis files, the masses and frictions are drawn. A case is right when every parameter is within
four of its standard errors of the truth; it is open when the tool calls the fit unusable. Besides: which machine
`--init` takes the recording for without `--machine`, and its error over the noise."""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "release").resolve()
SEEDS = int(sys.argv[2]) if len(sys.argv) > 2 else 5
SAMPLE, STEPS = 1e-3, 100
SECONDS = 4.0


def profile(rng, reach, rate):
    """A smooth reference to and fro: three sines of drawn frequencies, which begins at rest."""
    t = np.arange(int(SECONDS / SAMPLE)) * SAMPLE
    waves = [(rng.uniform(0.3, 1.0) * reach / k, rate * k * rng.uniform(0.8, 1.2)) for k in (1, 2.3, 5.1)]
    begin = 1.0 - np.exp(-((t / 0.3) ** 2))
    return t, begin * sum(a * np.sin(2 * math.pi * f * t) for a, f in waves)


def step(v, force, friction, mass, h):
    """The velocity after h seconds and the way gone, under force(v) and dry friction."""
    direction = math.copysign(1.0, v) if v else 0.0
    if not v and abs(force(0.0)) > friction:
        direction = math.copysign(1.0, force(0.0))
    if not direction:
        return 0.0, 0.0
    middle = v + 0.5 * h * (force(v) - direction * friction) / mass
    after = v + h * (force(middle) - direction * friction) / mass
    if after * direction < 0.0:
        after = 0.0
    return after, 0.5 * h * (v + after)


def run(reference, control, plant):
    """Position and command at every sample. `control` makes the command of reference, position and the two
    before; `plant` goes on for a sample under a command and returns the position."""
    q = before = 0.0
    last = reference[0]
    positions, commands = [], []
    for r in reference:
        u = control(r, last, q, before)
        positions.append(q)
        commands.append(u)
        before, last = q, r
        q = plant(u)
    return np.array(positions), np.array(commands)


def one_mass(truth, drive, weight=lambda q: 0.0, mu=0.0):
    """A plant of one mass. `drive` is a force of command and velocity; friction grows by `mu` times that."""
    q = v = 0.0

    def plant(u):
        nonlocal q, v
        for _ in range(STEPS):
            against = weight(q)
            v, way = step(v, lambda w: drive(u, w) - against - truth["viscous"] * w,
                          truth["coulomb"] + mu * abs(drive(u, v)), truth["mass"], SAMPLE / STEPS)
            q += way
        return q

    return plant


def tracking(stiffness, damping, limit):
    """A controller that follows the reference; its command is what is recorded."""
    def control(r, last, q, before):
        u = stiffness * (r - q) + damping * ((r - last) - (q - before)) / SAMPLE
        return max(-limit, min(limit, u))
    return control


def rounded(values, step):
    return step * np.floor(values / step)


def moving(rng, lowest, highest, viscous, coulomb):
    return {"mass": rng.uniform(lowest, highest), "viscous": rng.uniform(*viscous), "coulomb": rng.uniform(*coulomb)}


def screw(rng):
    truth = moving(rng, 40, 90, (150, 600), (15, 40))
    t, r = profile(rng, 0.04, 1.0)
    q, u = run(r, tracking(900, 18, 20), one_mass(truth, lambda u, v: 113.0973 * u))
    return truth, {"time_s": t, "motor_current_a": u, "position_mm": 1e3 * rounded(q, 1e-6)}


def linear_motor(rng):
    truth = moving(rng, 4, 15, (10, 40), (3, 12))
    t, r = profile(rng, 0.05, 1.2)
    q, u = run(r, tracking(500, 10, 20), one_mass(truth, lambda u, v: 60.0 * u))
    return truth, {"t [ms]": 1e3 * t, "iq [A]": u, "x [um]": 1e6 * rounded(q, 0.5e-6)}


def belt(rng):
    """Stiff enough for the sum of the masses to be what counts; the motor's is known."""
    truth = moving(rng, 5, 12, (10, 40), (8, 20))
    motor, stiffness, damping = 2e-4 / 0.02**2, 200e3, 100.0
    t, r = profile(rng, 0.06, 1.0)
    h, q, w, x, v = SAMPLE / STEPS, 0.0, 0.0, 0.0, 0.0

    def plant(u):
        nonlocal q, w, x, v
        for _ in range(STEPS):  # motor and carriage about the same middle
            middle_q, middle_x = q + 0.5 * h * w, x + 0.5 * h * v
            pull = stiffness * (middle_q - middle_x) + damping * (w - v)
            motor_after = w + h * (25.0 * u - pull) / motor
            v, way = step(v, lambda s: pull - truth["viscous"] * s, truth["coulomb"], truth["mass"], h)
            q += 0.5 * h * (w + motor_after)
            w = motor_after
            x += way
        return q

    positions, currents = run(r, tracking(400, 12, 30), plant)
    return truth, {"time_s": t, "current_A": currents, "position_mm": 1e3 * rounded(positions, 1e-6)}


def turntable(rng):
    truth = moving(rng, 1, 4, (0.5, 2), (2, 8))
    t, r = profile(rng, 1.0, 0.7)
    q, u = run(r, tracking(60, 6, 30), one_mass(truth, lambda u, v: 8.0 * u))
    return truth, {"time_s": t, "iq [A]": u, "angle [deg]": np.degrees(rounded(q, 2 * math.pi / 1e6))}


def geared_joint(rng):
    truth = moving(rng, 2, 5, (5, 20), (4, 12))
    truth |= {"sine": rng.uniform(30, 70), "mu": rng.uniform(0.05, 0.15)}
    t, r = profile(rng, 0.8, 0.7)
    q, u = run(r, tracking(12, 1, 3), one_mass(truth, lambda u, v: 127.0 * u, lambda q: truth["sine"] * math.sin(q), truth["mu"]))
    return truth, {"time [s]": t, "torque [%]": 100 * u, "angle [deg]": np.degrees(rounded(q, 2 * math.pi / 1e6))}


def hobby_servo(rng):
    """Goal and encoder alone."""
    truth = moving(rng, 0.004, 0.009, (0.002, 0.02), (0.01, 0.05))
    truth["sine"] = 0.4807
    t, r = profile(rng, 0.7, 0.7)
    control = lambda r, last, q, before: max(-7.3, min(7.3, 8.402 * (r - q)))
    q, _ = run(r, control, one_mass(truth, lambda u, v: 0.3 * (u - 0.3 * v) / 5.0, lambda q: 0.4807 * math.sin(q)))
    return truth, {"time [s]": t, "goal position [rad]": r, "position [rad]": rounded(q, 2 * math.pi / 4096)}


def rack(rng):
    """A gap of known size between motor and carriage."""
    truth = moving(rng, 25, 60, (60, 200), (15, 50))
    motor, stiffness, damping, gap = 0.5e-4 / 0.005**2, 2e6, 500.0, 0.05e-3
    t, r = profile(rng, 0.08, 1.0)
    h, q, w, x, v = SAMPLE / STEPS, 0.0, 0.0, 0.0, 0.0

    def plant(u):
        nonlocal q, w, x, v
        for _ in range(STEPS):
            apart = q - x + 0.5 * h * (w - v)
            beyond = apart - max(-gap, min(gap, apart))
            pull = stiffness * beyond + damping * (w - v) if beyond else 0.0
            motor_after = w + h * (60.0 * u - pull) / motor
            v, way = step(v, lambda s: pull - truth["viscous"] * s, truth["coulomb"], truth["mass"], h)
            q += 0.5 * h * (w + motor_after)
            w = motor_after
            x += way
        return q

    positions, currents = run(r, tracking(1500, 40, 30), plant)
    return truth, {"time_s": t, "current_A": currents, "position_mm": 1e3 * rounded(positions, 1e-6)}


def velocity_loop(rng):
    """The loop of the paper under levels of the set velocity: preamplifier, current loop, gear, arm."""
    truth = {"limit": rng.uniform(2.2, 3.2), "viscous": rng.uniform(120, 300), "gear": rng.uniform(3e6, 8e6),
             "damping": rng.uniform(1000, 2500), "pole": rng.uniform(0.03, 0.08)}
    R, L, K, J, B, K_t, r_g, H, M = 0.56, 2.35e-3, 0.289, 8.47e-4, 7.33e-4, 0.0668, 5.73e-3, 1e-5, 146.0
    T_z, T_r, K_1, K_2, K_i, V_s, K_v = 7.05e-3, 1.59e-4, 1014.2, 870.0, 3.0, 95.0, 1000.0
    V_L, T_p = truth["limit"], truth["pole"]
    t = np.arange(int(2.4 / SAMPLE)) * SAMPLE
    u = np.repeat(rng.uniform(0.4, 1.0, 6) * np.array([9, -7, 4, -9, 6, -3]), len(t) // 6)
    h, y, v, q, w, p, dp, i = 1e-6, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    columns = np.zeros((4, len(t)))
    decay = math.exp(-h * (K_v / K_i + R) / L)
    for k, level in enumerate(u):
        for part in range(round(SAMPLE / h)):  # the loop is stiff
            apart = r_g * q - y
            beyond = apart - max(-H, min(H, apart))
            pull = truth["gear"] * beyond + truth["damping"] * (r_g * w - v) if beyond else 0.0
            acceleration = (pull - truth["viscous"] * v) / M
            if part == 0:
                columns[:, k] = rounded(r_g * q, 9e-6), v, acceleration, i
            ddp = (K_1 * level - K_2 * K_t * w - p - (T_p + T_r) * dp) / (T_p * T_r)
            dp += h * ddp
            p += h * dp
            v_c = max(-V_L, min(V_L, p + T_z * dp))
            if abs(K_v * (v_c - i / K_i)) < V_s:  # the current settles at once
                steady = (K_v * v_c - K * w) / (K_v / K_i + R)
                i = steady + (i - steady) * decay
            else:
                i += h * (math.copysign(V_s, v_c - i / K_i) - R * i - K * w) / L
            w += h * (K * i - B * w - r_g * pull) / J
            v += h * acceleration
            q += h * w
            y += h * v
    noise = rng.standard_normal((3, len(t)))
    return truth, {"time_s": t, "set_velocity_v": u, "position_m": columns[0],
                   "velocity_mps": columns[1] + 2e-3 * noise[0],
                   "acceleration_mps2": columns[2] + 0.05 * noise[1],
                   "motor_current_a": columns[3] + 0.02 * noise[2]}


MACHINES = {"velocity-loop": velocity_loop, "rack": rack, "screw": screw, "belt": belt, "linear-motor": linear_motor, "turntable": turntable,
            "geared-joint": geared_joint, "hobby-servo": hobby_servo}
NAMES = {"mass": ("M", "J"), "viscous": ("B_a",), "coulomb": ("coulomb_friction.F_c", "coulomb_friction.T_c"),
         "sine": ("pendulum_gravity.G_s",), "mu": ("load_friction.mu",), "limit": ("V_L",), "gear": ("k_g",),
         "damping": ("b_g",), "pole": ("T_p",)}


def fit(machine, columns, folder):
    rows = [",".join(columns)] + [",".join(f"{x:.9g}" for x in row) for row in zip(*columns.values())]
    (folder / "run.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    program = BUILD / "apps" / "fit-params"
    for command in (["--init", "--machine", machine, "run.csv"], ["job.yaml", "--json"]):
        done = subprocess.run([program, *command], cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode not in (0, 1, 3):
            return None, done.stderr
    return json.loads(done.stdout), ""


def choose(columns, folder):
    """The machine that --init takes a recording for, and by how much its error is smaller than that of one mass."""
    done = subprocess.run([BUILD / "apps" / "fit-params", "--init", "run.csv", "--output", "chosen"], cwd=folder,
                          capture_output=True, text=True, check=False)
    rows = [line.split() for line in done.stderr.splitlines() if line.startswith("    ") and "fit-params" not in line]
    errors = {" ".join(row[:-3] if row[-1] == "chosen" else row[:-2]): row[-2 if row[-1] == "chosen" else -1]
              for row in rows if row[0] != "axis"}
    if not errors:
        return "one of its kind", ""
    chosen = next(iter(errors))
    return chosen, f"{errors[chosen]}, one mass {errors.get('one mass', 'no fit')}"


def judge(truth, result):
    worst = ("", 0.0)
    for p in result["parameters"]:
        key = next((k for k, names in NAMES.items() if p["name"] in names), None)
        if key is None or key not in truth:
            continue
        if not p["standard_error"]:
            return f"undetermined: {p['name']}"
        away = abs(p["value"] - truth[key])
        if away / p["standard_error"] > worst[1]:
            worst = (p["name"], away / p["standard_error"])
    if not result["usable"]:
        return f"open: {result['grade']}"
    return "right" if worst[1] <= 4.0 else f"wrong: {worst[0]} by {worst[1]:.1f} standard errors"


def main():
    right = total = 0
    print("| machine | seed | result | taken for | error |\n|---|---|---|---|---|")
    for name in sys.argv[3:] or MACHINES:
        simulate = MACHINES[name]
        for seed in range(1, SEEDS + 1):
            truth, columns = simulate(np.random.default_rng(seed))
            with tempfile.TemporaryDirectory() as folder:
                result, said = fit(name, columns, pathlib.Path(folder))
                chosen, error = choose(columns, pathlib.Path(folder))
            verdict = judge(truth, result) if result else "refused: " + (said.strip().splitlines() or ["?"])[-1]
            right += verdict == "right"
            total += 1
            print(f"| {name} | {seed} | {verdict} | {chosen} | {error} |", flush=True)
    print(f"\n{right} of {total} are right.")
    return 0 if right == total else 1


if __name__ == "__main__":
    sys.exit(main())
