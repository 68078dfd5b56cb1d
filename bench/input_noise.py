#!/usr/bin/python3
"""input_noise.py [BUILD] [--fits N]: how often 95 % intervals contain the truth where the command
was recorded with noise that never moved the axis. The slide is that of honesty.py, simulated by
fixed steps; the noise is in per cent of the range of its command. A velocity is fitted free-running, a position
at the observer gain that `fit-params --init` chooses for the recording."""
import argparse
import concurrent.futures
import json
import math
import pathlib
import random
import re
import subprocess
import tempfile

from honesty import ROOT, SLIDE, Job, follow, path

CASES = [(level, signals) for signals in ("velocity", "position") for level in (0.1, 1.0, 5.0)]
NOISE = {"velocity": 0.002, "position": 2e-6}


def suggested_gain(program, folder, csv):
    subprocess.run([program, "--init", csv], cwd=folder, check=True, capture_output=True)
    text = pathlib.Path(folder, "job.yaml").read_text()
    return re.search(r"observer: \{fixed: (.*?)\}", text)[1]


def errors(program, level, signal, seed):
    """Of every parameter: its error in standard errors, and whether its interval has the truth."""
    rng = random.Random(seed)
    log = SLIDE.run(follow(SLIDE, path(rng, 4.0)))
    size = 0.01 * level * (max(log["command"]) - min(log["command"]))
    log["command"] = [u + rng.gauss(0.0, size) for u in log["command"]]
    job = Job(f"input noise {seed}")
    job.add(job.measure(log, **{signal: NOISE[signal]}), file="fit.csv")
    job.declare(SLIDE)
    with tempfile.TemporaryDirectory() as folder:
        if signal == "position":
            columns = {"time": "time_s", "command": "motor_current_a", "position": "position_m"}
            record = job.files["fit.csv"]
            job.files["fit.csv"] = {columns[name]: values for name, values in record.items()}
            with tempfile.TemporaryDirectory() as empty:
                job.write(folder)
                pathlib.Path(folder, "fit.csv").rename(pathlib.Path(empty, "fit.csv"))
                gain = suggested_gain(program, empty, "fit.csv")
            job.fit = {"observer": {"fixed": gain}}
            job.files["fit.csv"] = record
        job.write(folder)
        done = subprocess.run([program, "job.yaml", "--json", "--threads", "1"], cwd=folder,
                              capture_output=True, text=True)  # fmt: skip
    found = {}
    for p in json.loads(done.stdout)["parameters"]:
        truth = job.truth[p["name"]]
        if p["standard_error"] is None:
            continue
        low, high = p["confidence_interval"]
        found[p["name"]] = ((p["value"] - truth) / p["standard_error"], low <= truth <= high)
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("build", nargs="?", type=pathlib.Path, default=ROOT / "build" / "release")
    parser.add_argument("--fits", type=int, default=200, help="of each case")
    options = parser.parse_args()
    program = (options.build / "apps" / "fit-params").resolve()
    print(f"{'noise':>6}  {'signal':<9} {'parameter':<22} {'rms':>5} {'mean':>6} {'intervals':>10}")
    with concurrent.futures.ThreadPoolExecutor() as pool:
        for level, signal in CASES:
            seeds = range(options.fits)
            fits = list(pool.map(lambda s: errors(program, level, signal, s), seeds))
            for name in fits[0]:
                found = [f[name] for f in fits if name in f]
                n = len(found)
                rms = math.sqrt(sum(z * z for z, _ in found) / n)
                mean = sum(z for z, _ in found) / n
                held = 100.0 * sum(h for _, h in found) / n
                print(f"{level:>5} %  {signal:<9} {name:<22} {rms:>5.2f} {mean:>+6.2f} "
                      f"{held:>8.1f} %", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
