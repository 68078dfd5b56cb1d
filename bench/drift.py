#!/usr/bin/python3
"""drift.py [BUILD [DRIFTING [STEADY]]]: does `--close-loop` name friction that drifts?

The slides of bench/scatter.py, simulated there and not by the project, for 60 s, once to be fitted and once to
validate. The friction of DRIFTING machines (default 20) falls by 5 % while they run, with a time constant of 10 to
40 s; that of STEADY ones (default 20) does not. Counted is how often an effect that fades with time or distance is
accepted."""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

import scatter

DRIFTING, STEADY = (int(sys.argv[i]) if len(sys.argv) > i else 20 for i in (2, 3))
FADING = {"warming_friction", "warming_grease", "running_in_friction"}


def accepted(forces, places):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        job = scatter.write_job(folder, forces, places, roles=["fit", "validate"])
        done = subprocess.run([scatter.BUILD / "apps" / "fit-params", job, "--close-loop", "--json"], cwd=folder,
                              capture_output=True, text=True, check=False)
        result = json.loads(done.stdout) if done.stdout else sys.exit(done.stderr)
        return [e["name"] for e in result["effects"] if e["decision"] == "accepted"], result["wall_time_s"]


def main():
    scatter.SAMPLES = int(60.0 / scatter.SAMPLE)
    print("| friction | accepted | loop, s |\n|---|---|---|")
    named = {True: 0, False: 0}
    for drifts, count in ((True, DRIFTING), (False, STEADY)):
        for seed in range(count):
            rng = np.random.default_rng(300 + seed)
            machine, constant = scatter.draw(rng), rng.uniform(10.0, 40.0)
            fade = lambda t: 1.0 - 0.05 * drifts * (1.0 - np.exp(-t / constant)) / (1.0 - np.exp(-60.0 / constant))
            same = lambda value: np.full(2, value)
            forces, places = scatter.simulate(rng, same(machine["mass"]), same(machine["viscous"]),
                                              same(machine["coulomb"]), same(machine["offset"]), fade)
            names, seconds = accepted(forces, places)
            named[drifts] += bool(FADING & set(names))
            print(f"| {'drifts' if drifts else 'steady'} | {', '.join(names) or 'nothing'} | {seconds:.0f} |", flush=True)
    print(f"\nFading friction is named in {named[True]} of {DRIFTING} machines in which it drifts, and in {named[False]} of "
          f"{STEADY} in which it does not.")


if __name__ == "__main__":
    main()
