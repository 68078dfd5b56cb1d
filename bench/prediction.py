#!/usr/bin/python3
"""prediction.py [BUILD [MACHINES]]: do the bands of `--predict` hold recordings that were not fitted?

The slides of bench/scatter.py, simulated there and not by the project: from recording to recording friction
scatters by 5 %, a constant force by 1 N, the drive's constant by 1 %; or nothing does. MACHINES (default 60)
machines with 3, 5 and 10 recordings that are fitted, and one more that is predicted, free running, from its
measured force. Counted is how much of these the 95 % bands hold, at any one time and as whole curves, and the
median half width over the root mean square of the error."""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

import scatter

MACHINES = int(sys.argv[2]) if len(sys.argv) > 2 else 60


def predict(forces, places):
    """The prediction of the last recording, as fit-params tells it."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        job = scatter.write_job(folder, forces, places, roles=["fit"] * (len(forces) - 1) + ["validate"])
        done = subprocess.run([scatter.BUILD / "apps" / "fit-params", job, "--predict", "--json"], cwd=folder,
                              capture_output=True, text=True, check=False)
        result = json.loads(done.stdout) if done.stdout else sys.exit(done.stderr)
        return result.get("prediction"), result


def main():
    print("| scatter | recordings | held at any one time | whole curves held | half width over error, median |\n"
          "|---|---|---|---|---|")
    for scatters in (True, False):
        for count in (3, 5, 10):
            rng = np.random.default_rng(7000 + count + 100 * scatters)
            inside, whole, widths, lost = [], 0, [], 0
            for _ in range(MACHINES):
                forces, places = scatter.record(rng, scatter.draw(rng), scatters, count + 1)
                prediction, _ = predict(forces, places)
                if not prediction or not prediction[0]["signals"]:
                    lost += 1
                    continue
                signal = prediction[0]["signals"][0]
                inside.append(signal["inside_percent"])
                whole += signal["whole_curve_inside"]
                widths.append(signal["half_width_median"] / signal["rmse"])
            print(f"| {'yes' if scatters else 'no'} | {count} | {np.mean(inside):.1f} % | "
                  f"{100 * whole / len(inside):.1f} % | {np.median(widths):.2f} |"
                  + (f" {lost} without a band |" if lost else ""), flush=True)


if __name__ == "__main__":
    main()
