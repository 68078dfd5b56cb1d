#!/usr/bin/python3
"""horizon.py BUILD EMPS [HORIZON...]: the free run through EMPS's pulses by models that were fitted to its
training record with several horizons, and the 95 % band about it: its half width in the median, and how much of the
error it holds. EMPS is the folder of the benchmark's two MATLAB files. The last line of each model is `horizon: auto`,
which knows the training record alone."""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import yaml

HORIZONS = ("one step", "62 ms", "0.2 s", "0.6 s", "2 s", "6.2 s", "whole", "auto")
EFFECTS = {"four parameters": {}, "with directional_friction":
           {"directional_friction.dB_a": {"bounds": ["-100 N s/m", "100 N s/m"]}}}


def errors(build, data, free, criterion):
    root = pathlib.Path(__file__).resolve().parent.parent
    job = yaml.safe_load((root / "configs/jobs/emps.yaml").read_text(encoding="utf-8"))
    job["axis"] = str(root / "configs/axes/emps.yaml")
    job["effects"] = {name.split(".")[0]: {} for name in free}
    job["free"].update(free)
    job["fit"] = criterion
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "job.yaml"
        path.write_text(yaml.safe_dump({k: v for k, v in job.items() if v}), encoding="utf-8")
        done = subprocess.run([build / "apps" / "fit-params", path, "--data", data, "--predict", "--json"],
                              capture_output=True, text=True, check=False)
        result = json.loads(done.stdout) if done.stdout else sys.exit(done.stderr)
    band = next(p["signals"][0] for p in result["prediction"] if p["recording"] == "pulses")
    return [r["signals"][0]["rmse"] for r in result["recordings"]], band, result


def name_of(criterion, result):
    if "observer" in criterion:
        return "one step ahead"
    if criterion["horizon"] != "auto":
        return criterion["horizon"]
    trial = result["horizon"]["trials"][result["horizon"]["chosen"]]
    window = f"{trial['horizon_s']:.3g} s" if trial["horizon_s"] > 0.0 else "whole"
    return "auto: " + ("one step ahead" if trial["observer_gain"] > 0.0 else window)


def main():
    if len(sys.argv) < 3:
        sys.exit(re.sub(r":.*", "", __doc__, flags=re.DOTALL))
    build, data = map(pathlib.Path, sys.argv[1:3])
    print("| model | horizon | error on train, mm | error on pulses, mm | band, mm | inside | time, s |")
    print("|---" * 7 + "|")
    for model, free in EFFECTS.items():
        for horizon in sys.argv[3:] or HORIZONS:
            criterion = {"observer": {"fixed": "300 1/s"}} if horizon == "one step" else {"horizon": horizon}
            (train, pulses), band, result = errors(build, data.resolve(), free, criterion)
            print(f"| {model} | {name_of(criterion, result)} | {1e3 * train:.2f} | {1e3 * pulses:.2f} | "
                  f"+-{1e3 * band['half_width_median']:.1f} | {band['inside_percent']:.1f} % | "
                  f"{result['wall_time_s']:.0f} |", flush=True)


if __name__ == "__main__":
    main()
