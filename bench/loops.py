#!/usr/bin/python3
"""loops.py [BUILD]: how often, and how fast, `--close-loop` is right on the paper's axis where the
axis file does not declare one effect, or two.

Every case draws an axis, an effect, the noise and three motions: levels and a chirp to fit, a
random sequence to validate. The axis is simulated by loops/paper_axis.cpp, not by the project. Five
parameters are fitted to velocity and acceleration, from initial values that are far off. A case is

- `right` if what is accepted is what acts, under one of the names that stand for it, and no
  parameter is at a bound,
- `undecided` if that, or the rest of it, is among what the search calls undecided,
- `missed` if what acts is not named, nor anything else, though the model leaves more than noise,
- `unseen` if it is not named, and the declared model explains all but the noise,
- `wrong` otherwise, or if there is no result.

`s` is the processor time of the program with one thread. The shares are those of its work, as in
result.json."""
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

ROOT = pathlib.Path(__file__).resolve().parent.parent
COMMAND = 5e-3  # s, how long the controller holds a voltage
ENDS = ("right", "undecided", "missed", "wrong", "unseen")
WORK = ("fits", "scores", "trials", "substitutes", "errors")


@dataclasses.dataclass
class Kind:
    """`acts` draws what acts, as values of paper_axis.cpp. `names` are the sets of effects that
    stand for it: more than one where they say the same of these recordings."""

    acts: object
    names: list


def one_of(*names):
    return [{name} for name in names]


def either_sign(r, low, high):
    return r.choice((-1, 1)) * r.uniform(low, high)


# Strengths that change the velocity by several times its noise; places, periods and times that the
# motions pass often.
KINDS = {
    "none": Kind(lambda r: {}, [set()]),
    "coulomb": Kind(lambda r: {"coulomb": r.uniform(6, 35)}, one_of("coulomb_friction")),
    "stribeck": Kind(
        lambda r: {"coulomb": r.uniform(8, 25), "stribeck": r.uniform(15, 40),
                   "stribeck_speed": r.uniform(0.03, 0.1)},
        [{"coulomb_friction", "stribeck_friction"}]),
    "drag": Kind(lambda r: {"drag": r.uniform(25, 100)}, one_of("quadratic_drag")),
    "offset": Kind(lambda r: {"offset": either_sign(r, 8, 35)}, one_of("constant_force")),
    "spring": Kind(lambda r: {"spring": r.uniform(20, 80)}, one_of("stroke_spring")),
    "period": Kind(
        lambda r: {"ripple": r.uniform(8, 30), "period": r.uniform(0.015, 0.06),
                   "phase": r.uniform(0, 6.28)},
        one_of("periodic_force", "cogging_torque")),
    "bump": Kind(
        lambda r: {"bump": r.uniform(40, 100), "bump_at": r.uniform(0.12, 0.28),
                   "bump_width": r.uniform(0.03, 0.08)},
        one_of("friction_bump")),
    "payload": Kind(lambda r: {"payload": either_sign(r, 7, 25)}, one_of("added_mass")),
    "mode": Kind(
        lambda r: {"swing": r.uniform(10, 35), "swing_hz": r.uniform(8, 25),
                   "swing_damping": r.uniform(0.01, 0.05)},
        one_of("elastic_mode")),
    "torque ripple": Kind(
        lambda r: {"torque_ripple": r.uniform(0.03, 0.12), "order": r.randint(3, 9),
                   "phase": r.uniform(0, 6.28)},
        one_of("torque_ripple")),
    "fade": Kind(
        lambda r: {"fade": r.uniform(0.08, 0.25), "fade_time": r.uniform(1.5, 6)},
        one_of("torque_fade")),
    "dead time": Kind(lambda r: {"dead_time": r.uniform(0.003, 0.012)}, one_of("dead_time")),
    "bias": Kind(lambda r: {"bias": either_sign(r, 0.06, 0.25)}, one_of("acceleration.bias")),
    "gain": Kind(lambda r: {"gain": 1 + either_sign(r, 0.03, 0.08)}, one_of("acceleration.gain")),
    "lag": Kind(lambda r: {"lag": r.uniform(0.001, 0.004)}, one_of("acceleration.lag")),
    "two levels": Kind(
        lambda r: {"coulomb": r.uniform(15, 35), "direction": either_sign(r, 5, 12)},
        [{"coulomb_friction", "directional_friction"}, {"coulomb_friction", "constant_force"}]),
    "coulomb and period": Kind(
        lambda r: {"coulomb": r.uniform(8, 30), "ripple": r.uniform(8, 25),
                   "period": r.uniform(0.02, 0.05), "phase": r.uniform(0, 6.28)},
        [{"coulomb_friction", "periodic_force"}, {"coulomb_friction", "cogging_torque"}]),
    "pulse": Kind(
        lambda r: {"pulse": r.uniform(50, 100), "pulse_at": r.uniform(0.8, 1.6),
                   "pulse_length": r.uniform(0.25, 0.5)},
        one_of("force_over_time")),
    "offset and spring": Kind(
        lambda r: {"offset": either_sign(r, 10, 35), "spring": r.uniform(25, 80)},
        [{"constant_force", "stroke_spring"}]),
}  # fmt: skip


def declared(r):
    """What the axis is in the words of its file."""
    return {"V_L": r.uniform(2.2, 3.6), "B_a": r.uniform(110, 280), "b_g": r.uniform(900, 2400),
            "k_g": r.uniform(3e6, 8e6), "T_p": r.uniform(0.035, 0.07)}  # fmt: skip


# Motions: set-velocity voltages. All go forwards and back first: they share a part of the stroke.


def held(steps):
    """Voltages from pairs of volts and seconds."""
    return [volts for volts, time in steps for _ in range(round(time / COMMAND))]


def levels(r):
    """There and back, rest, a creep, and there again."""
    way = [(9.0, 0.7), (-7.0, 1.0), (0.0, 0.3), (2.0, 0.4), (7.0, 0.5), (-3.5, 0.4), (0.0, 0.2)]
    return held((volts * r.uniform(0.8, 1.0), time * r.uniform(0.9, 1.1)) for volts, time in way)


def chirp(r, seconds=4.0):
    peak, first, last = r.uniform(5, 7), r.uniform(0.3, 0.4), r.uniform(1.5, 3)
    rise = (last - first) / (2 * seconds)
    times = [k * COMMAND for k in range(round(seconds / COMMAND))]
    return [peak * math.sin(2 * math.pi * (first + rise * t) * t) for t in times]


def sequence(r, seconds=4.0):
    steps = [(r.uniform(6, 8), 0.6), (r.uniform(-8, -6), 0.8)]
    while sum(time for _, time in steps) < seconds:
        steps.append((r.uniform(-8, 8), r.uniform(0.1, 0.45)))
    return held(steps)


MOTIONS = {"levels": (levels, "fit"), "chirp": (chirp, "fit"), "sequence": (sequence, "validate")}


def compile_simulator(folder):
    program = folder / "paper_axis"
    source = ROOT / "bench" / "loops" / "paper_axis.cpp"
    subprocess.run(["g++", "-std=c++20", "-O3", source, "-o", program], check=True)
    return program


def record(simulator, path, r, values, commands, noise):
    """A recording with white noise on velocity and acceleration."""
    given = [f"{name}={value:.9g}" for name, value in values.items()]
    done = subprocess.run([simulator, *given], input="\n".join(map(str, commands)),
                          capture_output=True, text=True, check=True)  # fmt: skip
    rows = ["time,command,velocity,acceleration"]
    for line in done.stdout.splitlines():
        time, command, *readings = line.split()
        noisy = [float(x) + r.gauss(0.0, sigma) for x, sigma in zip(readings, noise)]
        rows.append(",".join([time, command, *(f"{x:.7g}" for x in noisy)]))
    path.write_text("\n".join(rows) + "\n")


def write_case(simulator, folder, r, acts):
    """Recordings and job.yaml, and the values that were drawn."""
    values = declared(r) | acts
    noise = r.uniform(1e-3, 3e-3), r.uniform(0.03, 0.08)  # m/s, m/s^2
    signals = {"command": {"column": "command", "unit": "V"}}
    for signal, unit, sigma in zip(("velocity", "acceleration"), ("m/s", "m/s^2"), noise):
        signals[signal] = {"column": signal, "unit": unit, "sigma": f"{sigma:.9g} {unit}"}
    recordings = []
    for name, (motion, role) in MOTIONS.items():
        record(simulator, folder / f"{name}.csv", r, values, motion(r), noise)
        time = {"column": "time", "unit": "s"}
        recordings.append({"file": f"{name}.csv", "role": role, "time": time, "signals": signals})
    free = {"V_L": "8 V", "B_a": "60 N s/m", "b_g": "5000 N s/m", "k_g": "1.5e6 N/m",
            "T_p": "0.1 s"}  # fmt: skip
    job = {"axis": str(ROOT / "configs" / "axes" / "x.yaml"), "recordings": recordings,
           "free": {name: {"initial": value} for name, value in free.items()}}  # fmt: skip
    (folder / "job.yaml").write_text(json.dumps(job, indent=1) + "\n")
    return values


@dataclasses.dataclass
class Outcome:
    kind: str
    label: str
    end: str  # one of ENDS
    said: str  # what was accepted, undecided or at a bound
    seconds: float
    work: dict  # s, by name
    stopped: bool  # by the time limit
    values: dict  # that were drawn


def judge(names, result):
    """One of ENDS, and what the result says."""
    effects = result.get("effects", [])
    accepted, undecided = ({e["name"] for e in effects if e["decision"] == decision}
                           for decision in ("accepted", "undecided"))  # fmt: skip
    at_bound = {p["name"] for p in result["parameters"] if p["verdict"] == "at bound"}
    said = ", ".join(sorted(accepted)) or "nothing"
    said += f"; undecided: {', '.join(sorted(undecided))}" if undecided else ""
    said += f"; at bound: {', '.join(sorted(at_bound))}" if at_bound else ""
    if accepted in names and not at_bound:
        return "right", said
    if any(accepted <= true <= accepted | undecided for true in names) and not at_bound:
        return "undecided", said
    if accepted or at_bound:
        return "wrong", said
    return "unseen" if result["grade"] == "explained" else "missed", said


def run(kind, number, options, simulator, folder):
    r = random.Random(f"{options.seed} {kind} {number}")
    label = f"{kind} {number}"
    folder = folder / label.replace(" ", "-")
    folder.mkdir()
    values = write_case(simulator, folder, r, KINDS[kind].acts(r))
    command = [options.build / "apps" / "fit-params", "job.yaml", "--close-loop", "--threads", "1",
               "--json", "--time-limit", str(options.time_limit)]  # fmt: skip
    with open(folder / "result.json", "w") as out, open(folder / "errors.txt", "w") as errors:
        child = subprocess.Popen(command, cwd=folder, stdout=out, stderr=errors)
        _, status, used = os.wait4(child.pid, 0)  # the time of this child alone
    child.returncode = os.waitstatus_to_exitcode(status)
    text = (folder / "result.json").read_text()
    end, said, work = "wrong", f"no result, exit code {child.returncode}", {}
    if text.strip():
        result = json.loads(text)
        end, said = judge(KINDS[kind].names, result)
        work = {name: result["work"][name]["processor_time_s"] for name in WORK}
    return Outcome(kind, label, end, said, used.ru_utime + used.ru_stime, work,
                   child.returncode == 124, values)  # fmt: skip


def percent(part, whole):
    return f"{100 * part / whole:.0f} %" if whole else ""


def quantile(seconds, share):
    """The least time that so large a share of the cases does not exceed."""
    return sorted(seconds)[math.ceil(share * len(seconds)) - 1]


def print_table(outcomes):
    columns = ("kind", "cases", *ENDS, "s, median", "s, longest", *WORK)
    print(f"| {' | '.join(columns)} |\n{'|---' * len(columns)}|")
    for kind in [*dict.fromkeys(o.kind for o in outcomes), "all"]:
        of = [o for o in outcomes if kind in (o.kind, "all")]
        ends = collections.Counter(o.end for o in of)
        seconds = [o.seconds for o in of]
        work = [sum(o.work.get(name, 0.0) for o in of) for name in WORK]
        cells = [kind, len(of), *(ends[end] for end in ENDS), f"{statistics.median(seconds):.1f}",
                 f"{max(seconds):.1f}", *(percent(part, sum(work)) for part in work)]  # fmt: skip
        print(f"| {' | '.join(map(str, cells))} |")


def print_totals(outcomes):
    seen = [o for o in outcomes if o.end != "unseen"]
    right, wrong = (sum(o.end == end for o in seen) for end in ("right", "wrong"))
    seconds = [o.seconds for o in outcomes]
    if seen:
        print(f"\nOf {len(seen)} that are seen {right} are right ({100 * right / len(seen):.1f} %) "
              f"and {wrong} wrong ({100 * wrong / len(seen):.1f} %).")  # fmt: skip
    print(f"\nProcessor time: median {statistics.median(seconds):.1f} s, 95 % quantile "
          f"{quantile(seconds, 0.95):.1f} s, longest {max(seconds):.1f} s. The time limit stopped "
          f"{sum(o.stopped for o in outcomes)}.")  # fmt: skip


def print_others(outcomes):
    others = [o for o in outcomes if o.end != "right"]
    if others:
        print("\nNot right:\n\n| case | outcome | accepted | s | drawn |\n|---|---|---|---|---|")
    for o in others:
        drawn = ", ".join(f"{name} {value:.4g}" for name, value in o.values.items())
        print(f"| {o.label} | {o.end} | {o.said} | {o.seconds:.1f} | {drawn} |")


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)  # fmt: skip
    parser.add_argument("build", nargs="?", type=pathlib.Path, default=ROOT / "build" / "release")
    parser.add_argument("--cases", type=int, default=4, help="of each kind")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="cases at the same time")
    parser.add_argument("--kind", nargs="+", choices=KINDS, default=list(KINDS), metavar="NAME")
    parser.add_argument("--time-limit", type=int, default=100, help="s, of one case")
    parser.add_argument("--out", type=pathlib.Path, help="new folder for the files of all cases")
    options = parser.parse_args()
    options.build = options.build.resolve()
    cases = [(kind, number) for number in range(options.cases) for kind in options.kind]
    outcomes = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = (options.out or pathlib.Path(temporary)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        simulator = compile_simulator(pathlib.Path(temporary))
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            for o in pool.map(lambda case: run(*case, options, simulator, folder), cases):
                print(f"{o.end:<10} {o.label:<22} {o.seconds:6.1f} s  {o.said}", file=sys.stderr,
                      flush=True)  # fmt: skip
                outcomes.append(o)
    print(f"`bench/loops.py {' '.join(sys.argv[1:])}`: `--close-loop` on the paper's axis.\n")
    print_table(sorted(outcomes, key=lambda o: list(KINDS).index(o.kind)))
    print_totals(outcomes)
    print_others(outcomes)


if __name__ == "__main__":
    main()
