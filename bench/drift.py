#!/usr/bin/python3
"""drift.py [BUILD [DRIFTING [STEADY]]]: does `--close-loop` name friction that drifts?

The slides of bench/scatter.py, simulated there and not by the project, for 60 s, once to be fitted and once to
validate. The friction of DRIFTING machines (default 20) falls by 5 % while they run, with a time constant of 10 to
40 s; that of STEADY ones (default 20) does not. Counted is how often an effect that fades with time or distance is
accepted. Times are those of one thread, beside others on every core."""
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from scipy import stats

import scatter

DRIFTING, STEADY = (int(sys.argv[i]) if len(sys.argv) > i else 20 for i in (2, 3))
SECONDS, FALL = 60.0, 0.05
FADING = {"warming_friction", "warming_grease", "running_in_friction"}


def recorded(drifts, count):
    """Forces and positions of so many machines, twice each."""
    rng = np.random.default_rng(300 + drifts)
    machines = [scatter.draw(rng) for _ in range(count)]
    constant = np.repeat(rng.uniform(10.0, 40.0, count), 2)
    fallen = lambda time: (1.0 - np.exp(-time / constant)) / (1.0 - np.exp(-SECONDS / constant))
    twice = lambda name: np.repeat([machine[name] for machine in machines], 2)
    forces, places = scatter.simulate(rng, *map(twice, ("mass", "viscous", "coulomb", "offset")),
                                      lambda time: 1.0 - FALL * drifts * fallen(time))
    return list(zip(np.split(forces, count), np.split(places, count)))


def accepted(recordings):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        job = scatter.write_job(folder, *recordings, roles=["fit", "validate"])
        done = subprocess.run([scatter.BUILD / "apps" / "fit-params", job, "--close-loop", "--threads", "1", "--json"],
                              cwd=folder, capture_output=True, text=True, check=False)
        result = json.loads(done.stdout) if done.stdout else sys.exit(done.stderr)
        return [e["name"] for e in result["effects"] if e["decision"] == "accepted"], result["wall_time_s"]


def main():
    scatter.SAMPLES = int(SECONDS / scatter.SAMPLE)
    print("| friction | accepted | loop, s |\n|---|---|---|")
    named = {True: 0, False: 0}
    for drifts, count in ((True, DRIFTING), (False, STEADY)):
        if count == 0:
            continue
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            for names, seconds in pool.map(accepted, recorded(drifts, count)):
                named[drifts] += bool(FADING & set(names))
                print(f"| {'drifts' if drifts else 'steady'} | {', '.join(names) or 'nothing'} | {seconds:.0f} |",
                      flush=True)
    wrong = named[False]
    limit = stats.beta.ppf(0.975, wrong + 1, STEADY - wrong) if wrong < STEADY else 1.0
    print(f"\nFading friction is named in {named[True]} of {DRIFTING} machines in which it drifts, and in {wrong} of "
          f"{STEADY} in which it does not (upper 95 % limit {100.0 * limit:.1f} %).")


if __name__ == "__main__":
    main()
