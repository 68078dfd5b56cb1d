#!/usr/bin/python3
"""first_contact.py [BUILD [SEED]]: how far a newcomer gets. Twenty recordings, as tools of drives and loggers
write them, of machines that are simulated without the project's own simulator (machines.py): from
`fit-params --init` to the fit without an edit, or with one answer where the recording cannot tell.
A case is `within` when every parameter is within four of its standard errors of the truth, and those
are below a quarter of it; `honest` when the tool says that it cannot tell; `wrong` otherwise."""
import datetime
import gzip
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

from machines import Machine, levels, simulate

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "release").resolve()
SECONDS = 6
GAIN = ["--gain", "6.5"]
SEED = int(sys.argv[2]) if len(sys.argv) > 2 else 1
RNG = np.random.default_rng(SEED + 100)


def text(columns, names=None, separator=",", decimal=".", formats=None, above=(), below=()):
    """Rows of the columns, which may hold texts."""
    lines = list(above) + ([separator.join(names)] if names else []) + list(below)
    kinds = formats or ["%.7g"] * len(columns)
    for row in zip(*columns):
        fields = [f % x if not isinstance(x, str) else x for f, x in zip(kinds, row)]
        lines.append(separator.join(f.replace(".", decimal) for f in fields))
    return "\n".join(lines) + "\n"


def noisy(values, sigma):
    return values + sigma * RNG.standard_normal(len(values))


def stepped(values, resolution):
    return np.floor(values / resolution) * resolution


# Layouts: each takes a motion and returns the files and the answers.


def plain(m):
    return {"run.csv": text([m.time, m.current, noisy(m.position, 2e-6), noisy(m.velocity, 2e-3)],
                            ["time_s", "motor_current_a", "position_m", "velocity_mps"])}, GAIN


def counts(m):
    return {"geber.csv": text([1e3 * m.time, m.current, np.floor(m.position * 8e6)],
                              ["Zeit [ms]", "Motorstrom [A]", "Geber [Ink]"], ";", ",")}, [
        *GAIN, "--column", "position=Geber [Ink]:um/8"]


def degrees(m):  # a pinion of 25 mm
    deg = np.degrees(m.position / 0.025)
    return {"axis.csv": text([m.time, m.current, noisy(deg, 5e-3)], ["t [s]", "iq [A]", "q [deg]"])}, [
        *GAIN, "--column", f"position=q [deg]:mm*{25 * math.pi / 180:.10f}"]


def per_minute(m):
    return {"log.csv": text(
        [m.time, m.current, 1e3 * noisy(m.position, 2e-6), 6e4 * noisy(m.velocity, 2e-3)],
        ["Time (s)", "Current (A)", "Position (mm)", "Speed (mm/min)"])}, GAIN


def german(m):
    return {"Fahrt.csv": text(
        [1e3 * m.time, 1e3 * noisy(m.position, 2e-6), 1e3 * noisy(m.velocity, 2e-3), m.current],
        ["Zeit [ms]", "Istposition [mm]", "Ist-Geschwindigkeit [mm/s]", "Motorstrom [A]"],
        ";", ",")}, GAIN


def wrong_sign(m):
    half = len(m.time) // 2
    part = lambda s, sign: text([m.time[s], sign * m.current[s], noisy(m.position[s], 2e-6)],
                                ["time_s", "current_A", "pos_m"])
    return {"a.csv": part(slice(0, half), -1), "b.csv": part(slice(half, None), -1)}, GAIN


def noisy_input(m):
    return {"noisy.csv": text([m.time, noisy(m.current, 0.05), noisy(m.position, 2e-6)],
                              ["time_s", "current_A", "position_m"])}, GAIN


def late(m):
    position = noisy(np.concatenate([[0.0], m.position[:-1]]), 2e-6)
    return {"late.csv": text([m.time, m.current, position],
                             ["time_s", "current_A", "position_m"])}, GAIN


def preamble(m):
    above = ["Rig 7, Axis 2", "Operator,N. N.", "Date,2026-03-16", "Firmware,1.2.3", "Comment,",
             "Samples,6000", ""]
    return {"rig.csv": text([m.time, 1e3 * noisy(m.position, 2e-6), m.current],
                            ["Time", "Position", "Current"], above=above, below=["s,mm,A"])}, GAIN


def headerless(m):
    return {"log.txt": text([m.time, m.current, 1e3 * noisy(m.position, 2e-6),
                             1e3 * noisy(m.velocity, 2e-3)], separator="\t")}, GAIN


def two_files(m):
    keep = slice(1500, None)
    force = text([m.time, 6.5 * m.current], ["time_s", "force_N"])
    motion = text([m.time[keep] - m.time[keep][0], noisy(m.position[keep], 2e-6),
                   noisy(m.velocity[keep], 2e-3)], ["t_s", "pos_m", "vel_mps"])
    return {"motion.csv": motion, "force.csv": force}, []


def twincat(m):
    slow = slice(0, None, 2)
    head = ["Name\tLog", "File\tC:\\log.csv", "Starttime of export\t1\tMontag\t15:56", "", "",
            "Name\tActCurrent\tName\tActPos\tName\tActVelo",
            "SymbolComment\t\tSymbolComment\t\tSymbolComment\t",
            "Data-Type\tREAL32\tData-Type\tREAL64\tData-Type\tREAL64",
            "SampleTime[ms]\t1\tSampleTime[ms]\t2\tSampleTime[ms]\t2",
            "SymbolName\tA\tSymbolName\tB\tSymbolName\tC",
            "Unit\tA (Current)\tUnit\tmm (Length)\tUnit\tmm/s (Velocity)", ""]
    rows = [["%g" % (1e3 * t), "%.7g" % i] for t, i in zip(m.time, m.current)]
    for k, (t, p, v) in enumerate(zip(m.time[slow], noisy(m.position, 2e-6)[slow],
                                      noisy(m.velocity, 2e-3)[slow])):
        rows[k] += ["%g" % (1e3 * t), "%.7g" % (1e3 * p), "%g" % (1e3 * t), "%.7g" % (1e3 * v)]
    lines = ["\t".join(r + [" "] * (6 - len(r))) for r in rows]
    return {"scope.csv": "\n".join(head + lines + ["EOF"]) + "\n"}, GAIN


def labview(m):
    above = ["Timestamp,2026-03-16 17:04:51,Timestamp,2026-03-16 17:04:51",
             "Interval,0.001,Interval,0.001", 'Channel name,"Force",Channel name,"Linear scale"',
             'Unit,"N",Unit,"mm"']
    n = np.arange(len(m.time))
    return {"daq.csv": "\ufeff" + text([n, 6.5 * m.current, n, 1e3 * noisy(m.position, 2e-6)],
                                       above=above)}, []


def configurator(m):  # a screw of 100 mm, 40 N at 100 %
    above = ["Axis1", "Number of sampling data,6000", "Sampling time interval(ms),1",
             "Time,Analog 1,Analog 2,Analog 3,Digital 1"]
    zero = np.zeros(len(m.time))
    return {"graph.csv": text(
        [1e3 * m.time, 600 * noisy(m.velocity, 2e-3), 16.25 * m.current, zero, zero + 2.5],
        ["ms", "Servo motor speed", "Torque", "Not selected", "INP"], above=above)}, [
        "--column", "velocity=Servo motor speed:m/s/600", "--column", "force=Torque:N*0.4"]


def cia_402(m):
    return {"pdo.csv": text(
        [1e3 * m.time, np.floor(m.position * 1e6), np.round(m.velocity * 1e4), np.round(
            162.5 * m.current)],
        ["time_ms", "0x6064", "0x606C", "0x6077"])}, [
        "--column", "position=0x6064:um", "--column", "velocity=0x606C:m/s/10000", "--column",
        "force=0x6077:N*0.04"]


def messy(m):
    begin = datetime.datetime(2026, 3, 16, 17, 4, 51)
    clock = [(begin + datetime.timedelta(seconds=float(t))).isoformat(timespec="milliseconds")
             for t in m.time]
    state = ["idle" if i % 7 else "" for i in range(len(clock))]
    temperature = ["%.1f" % (20 + 0.001 * i) if i % 50 == 0 else "NaN" for i in range(len(clock))]
    zero = np.zeros(len(m.time))
    return {"export.csv": text(
        [clock, noisy(m.position, 2e-6), m.current, state, temperature, zero, zero],
        ["Timestamp", "Position [m]", "Current [A]", "State", "Temp", "flag", "flag"])}, GAIN


def several_rates(m):
    position = ["%.7g" % p if i % 4 == 0 else "" for i, p in enumerate(noisy(m.position, 2e-6))]
    return {"rates.csv.gz": text([m.time, m.current, position],
                                 ["time_s", "current_A", "position_m"])}, GAIN


def pi_drive(m):
    return {"drive.csv": text(
        [m.time, m.demand, noisy(m.velocity, 2e-3), noisy(m.position, 2e-6), m.current],
        ["time_s", "set_velocity_mps", "velocity_mps", "position_m", "current_A"])}, GAIN


def machines():
    r = np.random.default_rng(SEED)
    current = lambda: levels(r, 5.0, SECONDS)
    speed = lambda: levels(r, 0.4, SECONDS)
    rest = current()
    rest[1000:5200] = 0.0
    hold = levels(r, 5.0, SECONDS, mean=60.0 / 6.5)
    return {
        "plain SI units": (plain, Machine(demand=current())),
        "encoder counts": (counts, Machine(demand=current())),
        "degrees": (degrees, Machine(demand=current())),
        "mm/min": (per_minute, Machine(demand=current())),
        "German words, decimal commas": (german, Machine(demand=current())),
        "a weight": (plain, Machine(weight=60.0, demand=hold)),
        "a PI drive": (pi_drive, Machine(control="velocity", demand=speed())),
        "wrong sign, two files": (wrong_sign, Machine(demand=current())),
        "noise on the input": (noisy_input, Machine(demand=current())),
        "logged late by one sample": (late, Machine(demand=current())),
        "at rest for 70 % of the time": (plain, Machine(demand=rest)),
        "lines above the names": (preamble, Machine(demand=current())),
        "no header": (headerless, Machine(demand=current())),
        "force and motion in two files": (two_files, Machine(demand=current())),
        "TwinCAT Scope": (twincat, Machine(demand=current())),
        "LabVIEW": (labview, Machine(demand=current())),
        "MR Configurator": (configurator, Machine(demand=current())),
        "CiA 402 objects": (cia_402, Machine(demand=current())),
        "dates, texts, repeated names": (messy, Machine(demand=current())),
        "several rates, gzip": (several_rates, Machine(demand=current())),
    }


def fit(files, answers, folder):
    for name, contents in files.items():
        data = contents.encode()
        (folder / name).write_bytes(gzip.compress(data) if name.endswith(".gz") else data)
    program = BUILD / "apps" / "fit-params"
    made = subprocess.run([program, "--init", *files, *answers], cwd=folder, capture_output=True,
                          text=True)  # fmt: skip
    if made.returncode != 0:
        return None, made.stderr
    run = subprocess.run([program, "job.yaml", "--json"], cwd=folder, capture_output=True, text=True)
    if run.returncode not in (0, 3):
        return None, run.stderr
    return json.loads(run.stdout), made.stderr


def judge(result, said, machine):
    """Verdict, and the largest error in standard errors."""
    if result is None:
        return "refused: " + said.strip().splitlines()[-1], ""
    truth = {"M": machine.mass, "B_a": machine.viscous, "coulomb_friction.F_c": machine.coulomb,
             "constant_force.F_0": -machine.weight}  # fmt: skip
    worst, vague = ("", 0.0), []
    for p in result["parameters"]:
        if p["name"] not in truth:
            continue
        true, error = truth.pop(p["name"]), p["standard_error"]
        if error is None or error > max(0.25 * abs(true), 0.5):
            vague.append(p["name"])
            continue
        away = abs(p["value"] - true) / error
        if away >= worst[1]:
            worst = (p["name"], away)
    for name in ("M", "B_a", "coulomb_friction.F_c"):
        if name in truth:
            vague.append(name)
    grade = result["grade"]
    shown = f"{worst[1]:.1f} ({worst[0]})"
    if not result["usable"]:
        return f"honest: {grade}", shown
    if worst[1] > 4.0:
        return f"wrong ({grade})", shown
    if vague:
        return f"vague: {', '.join(vague)} ({grade})", shown
    return f"within ({grade})", shown


def main():
    cases = machines()
    motions = simulate([machine for _, machine in cases.values()])
    good = 0
    print(f"`bench/first_contact.py`: {len(cases)} recordings, from --init to the fit.\n")
    print("| recording | answers | result | largest error, standard errors |\n|---|---|---|---|")
    for (name, (layout, machine)), motion in zip(cases.items(), motions):
        files, answers = layout(motion)
        with tempfile.TemporaryDirectory() as folder:
            result, said = fit(files, answers, pathlib.Path(folder))
        verdict, worst = judge(result, said, machine)
        good += verdict.startswith(("within", "honest"))
        asked = " ".join(a for a in answers if not a.startswith("--")) or "none"
        print(f"| {name} | {asked} | {verdict} | {worst} |", flush=True)
    print(f"\n{good} of {len(cases)} reach the truth or say honestly that they do not.")
    return 0 if good == len(cases) else 1


if __name__ == "__main__":
    sys.exit(main())
