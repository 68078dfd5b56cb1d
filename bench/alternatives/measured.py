"""Recordings of real machines, which are not part of the project: EMPS and BAM.

They are read from a folder with `emps` (emps_train.csv, emps_test_pulses.csv and the two MATLAB files of
nonlinearbenchmark.org/benchmarks/emps) and `bam` (recordings of github.com/Rhoban/bam as text). What
these machines lack is not known, so that claims are shown and not judged. EMPS has two recordings: the
one to validate is also the one on which methods are compared.
"""
import dataclasses
import json

import numpy as np

from cases import Recording

EMPS_GAIN = 35.15065188248547  # N/V, published
BAM_GAIN, FULL_SCALE = 0.38670 / 4.0171, 885  # N m/V: k_t / R of the published model m1; of the PWM
BAM_FILES = {"fit": "sin_sin_8", "validate": "sin_time_square_11", "test": "up_and_down_10"}
BAM_STEP = 5e-3  # s


@dataclasses.dataclass
class Measured:
    name: str
    recordings: dict  # of the alternatives
    free: list
    job: object  # path of a job, made by prepare(folder)
    arguments: tuple = ()


def columns(path):
    table = np.genfromtxt(path, delimiter=",", names=True)
    return {name: table[name] for name in table.dtype.names}


def even(table, time, step):
    """The columns at even times from the first."""
    at = np.arange(time[0], time[-1], step)
    return at - at[0], {name: np.interp(at, time, values) for name, values in table.items()}


def emps(data, root):
    recordings = {}
    for role, file in (("fit", "emps_train.csv"), ("validate", "emps_test_pulses.csv")):
        table = columns(data / file)
        time, table = even(table, table["time_s"], 1e-3)
        recordings[role] = Recording(time, EMPS_GAIN * table["drive_voltage_v"], table["position_m"])
    recordings["test"] = recordings["validate"]
    job = root / "configs" / "jobs" / "emps-close-loop.yaml"
    return Measured("EMPS", recordings, ["M", "B_a"], lambda folder: job, ("--data", str(data)))


def bam(data, root):
    tables, recordings = {}, {}
    for role, file in BAM_FILES.items():
        raw = columns(data / f"{file}.csv")
        pwm = np.where(raw["load"] > 32767, raw["load"] - 65536, raw["load"])
        table = {"volts": pwm / FULL_SCALE * raw["input_volts"], "position": raw["position"]}
        tables[role] = np.column_stack([raw["timestamp"], *table.values()])
        time, table = even(table, raw["timestamp"], BAM_STEP)
        recordings[role] = Recording(time, BAM_GAIN * table["volts"], table["position"])
    return Measured("BAM", recordings, ["M", "B_a", "F_c"], lambda folder: bam_job(folder, tables))


def bam_job(folder, tables):
    """A pendulum on a servo as a rigid axis, 1 m for 1 rad: only dry friction is declared."""
    for role in ("fit", "validate"):
        np.savetxt(folder / f"{role}.csv", tables[role], "%.9g", ",", comments="",
                   header="time_s,drive_v,position_rad")  # fmt: skip
    axis = {"drive": "force_source", "transmission": "rigid",
            "parameters": {"K_f": f"{BAM_GAIN:.6g} N/V", "M": "0.005 kg", "B_a": "0.05 N s/m"},
            "effects": {"coulomb_friction": {"F_c": "0.01 N"}}}  # fmt: skip
    job = {"axis": "axis.yaml",
           "free": {"M": {}, "B_a": {}, "coulomb_friction.F_c": {"bounds": ["0 N", "1 N"]}},
           "fit": {"observer": {"fixed": "25 1/s"}},
           "recordings": [
               {"name": role, "file": f"{role}.csv", "role": role, "initial_state": "data",
                "time": {"column": "time_s", "unit": "s"},
                "signals": {"command": {"column": "drive_v", "unit": "V", "hold": "linear"},
                            "position": {"column": "position_rad", "unit": "m"}}}
               for role in ("fit", "validate")]}  # fmt: skip
    (folder / "axis.yaml").write_text(json.dumps(axis, indent=1) + "\n")
    (folder / "job.yaml").write_text(json.dumps(job, indent=1) + "\n")
    return folder / "job.yaml"


def available(data, root):
    """The measured cases whose folders are there, and the names of the others."""
    makers = {"EMPS": (emps, data / "emps"), "BAM": (bam, data / "bam")}
    found = [make(folder, root) for make, folder in makers.values() if folder.is_dir()]
    return found, [name for name, (_, folder) in makers.items() if not folder.is_dir()]
