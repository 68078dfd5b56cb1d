#!/usr/bin/env python3
"""Is the answer the same everywhere?

    same_answer_test.py BIN           with 1, 2 and 8 threads and where numbers have a decimal comma:
                                      to the last digit; on another processor: within 1e-9
    same_answer_test.py BIN OTHER...  from the programs of other builds, also of the shipped jobs,
                                      axes and motions: within 1e-9
"""

import atexit
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from answers import differences, numbers

BIN, *OTHERS = (pathlib.Path(argument).resolve() for argument in sys.argv[1:])
CONFIGS = pathlib.Path(__file__).resolve().parents[2] / "configs"

PLAIN = """
drive: force_source
transmission: rigid
parameters: {K_f: 10 N/V, M: 4 kg, B_a: 8 N s/m}
instruments: {velocity: {noise: 2 mm/s}, acceleration: {noise: 0.05 m/s^2}}
"""
RECORDING = """
  - {file: %s.csv, role: %s, time: {column: time_s, unit: s}, signals: {
      command: {column: command_v, unit: V},
      velocity: {column: velocity_mps, unit: m/s, sigma: 2 mm/s},
      acceleration: {column: acceleration_mps2, unit: m/s^2, fit: false}}}"""
FILES = {
    "plain.yaml": PLAIN,
    "rubbing.yaml": PLAIN + "effects: {coulomb_friction: {F_c: 6 N}}",
    "fitted.yaml": "{type: levels, levels: [3 V, -4 V, 1.5 V, 0 V], hold: 0.4 s, duration: 2 s}",
    "judged.yaml": "{type: levels, levels: [-2 V, 3.5 V, -1 V], hold: 0.5 s, duration: 1.5 s}",
    "job.yaml": "axis: plain.yaml\nrecordings:"
    + RECORDING % ("fitted", "fit")
    + RECORDING % ("judged", "validate")
    + "\nfree: {M: {initial: 10 kg}, B_a: {initial: 3 N s/m}}\n",
}


def run(texts, folder, environment, *command):
    """Adds what a command prints to the texts."""
    done = subprocess.run(command, cwd=folder, env=os.environ | environment,
                          capture_output=True, text=True)  # fmt: skip
    if done.returncode != 0:
        sys.exit(f"{command} fails with {environment}:\n{done.stderr}")
    texts[" ".join([command[0].name, *command[1:]])] = done.stdout


def answer(programs=BIN, threads=2, **environment):
    """All that the programs write, by name: recordings, and what a search with several starts finds
    in them. Without the time it took and the number of threads."""
    simulate, fit = programs / "simulate-axis", programs / "fit-params"
    with tempfile.TemporaryDirectory() as name:
        folder, texts = pathlib.Path(name), {}
        here = texts, folder, environment
        for file, text in FILES.items():
            (folder / file).write_text(text)
        for motion in ("fitted", "judged"):
            run(*here, simulate, "rubbing.yaml", motion + ".yaml", "--rate", "100",
                "--output", motion + ".csv")  # fmt: skip
        run(*here, fit, "--init", "fitted.csv", "--output", "initial")
        run(*here, fit, "job.yaml", "--close-loop", "--starts", "2", "--profile=M",
            "--output", "results", "--threads", str(threads))  # fmt: skip
        for file in folder.rglob("*.*"):
            texts[str(file.relative_to(folder))] = file.read_text()
    changing = r'("(?:wall|processor)_time_s": |<dt>Time taken</dt><dd>|--threads )[\d.e-]+'
    return {re.sub(changing, r"\1", k): re.sub(changing, r"\g<1>0", v) for k, v in texts.items()}


def shipped_answers(programs):
    """What the programs make of shipped jobs, and of the paper's axis in all motions."""
    texts = {}
    for job in ("paper", "paper-move", "payload", "screw"):
        run(texts, ".", {}, programs / "fit-params", str(CONFIGS / f"jobs/{job}.yaml"), "--json")
    for motion in sorted(CONFIGS.glob("motions/*.yaml")):
        run(texts, ".", {}, programs / "simulate-axis", str(CONFIGS / "axes/x.yaml"), str(motion),
            "--exact")  # fmt: skip
    return texts


def german():
    """The environment of a German locale, made anew since few systems have it, or nothing."""
    folder = tempfile.mkdtemp()
    atexit.register(shutil.rmtree, folder)
    environment = {"LOCPATH": folder, "LC_ALL": "de_DE.UTF-8"}
    try:
        subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", folder + "/de_DE.UTF-8"],
                       check=True, capture_output=True)  # fmt: skip
        point = subprocess.run(["locale", "decimal_point"], env=os.environ | environment,
                               check=True, capture_output=True, text=True).stdout  # fmt: skip
    except (OSError, subprocess.CalledProcessError):
        return {}
    return environment if point == ",\n" else {}


failures = []


def compare(circumstances, usual, other, extract):
    for name, text in usual.items():
        found = differences(extract(name, text), extract(name, other.get(name, "")))
        failures.extend(f"{circumstances}, {name}{difference}"[:300] for difference in found)


def text_of(_, text):
    return text


usual = answer()
if OTHERS:
    usual_shipped = shipped_answers(BIN)
    for programs in OTHERS:
        compare(programs, usual, answer(programs), numbers)
        compare(programs, usual_shipped, shipped_answers(programs), numbers)
else:
    compare("1 thread", usual, answer(threads=1), text_of)
    compare("8 threads", usual, answer(threads=8), text_of)
    # Where the C library knows them: instructions that change the last digit of a sine.
    older = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F"}
    compare("older processor", usual, answer(**older), numbers)
    locale = german()
    if locale:
        compare("German locale", usual, answer(**locale), text_of)
    else:
        print("not tested: there is no German locale, and localedef cannot make one")
print("\n".join(failures))
sys.exit(1 if failures else 0)
