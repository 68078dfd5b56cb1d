#!/usr/bin/python3
"""exported_c.py [BUILD [AXIS.yaml...]]: how long a step of 1 ms takes in exported C.

The axes (default: some of configs/axes) are exported with `--to c`, compiled with cc -O2 and moved for 2 s by a
command that is switched every 0.2 s. Printed is the mean of the fastest of five runs, in microseconds."""
import pathlib
import subprocess
import sys
import tempfile

PROJECT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else PROJECT / "build" / "release").resolve()
AXES = [pathlib.Path(a).resolve() for a in sys.argv[2:]] or [
    PROJECT / "configs" / "axes" / f"{name}.yaml" for name in ("emps", "pendulum", "screw", "belt", "x")]
DRIVER = """
#include <stdio.h>
#include <time.h>
#include "NAME.h"
int main(void) {
  double least = 1e9;
  for (int run = 0; run < 5; ++run) {
    static NAME_axis a;
    struct timespec from, to;
    NAME_init(&a);
    clock_gettime(CLOCK_MONOTONIC, &from);
    for (int k = 0; k < 2000; ++k) NAME_step(&a, k / 200 % 2 ? 3 : -3, (NAME_real)1e-3);
    clock_gettime(CLOCK_MONOTONIC, &to);
    double mean = (1e6 * (double)(to.tv_sec - from.tv_sec) + 1e-3 * (double)(to.tv_nsec - from.tv_nsec)) / 2000;
    if (mean < least) least = mean;
  }
  printf("%.2g", least);
  return 0;
}
"""


def step_time(axis, flags):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([BUILD / "apps" / "axisfit-export", axis, "--to", "c", "--output", folder], check=True,
                       stdout=subprocess.DEVNULL)
        name = next(pathlib.Path(folder).glob("*.h")).stem
        (pathlib.Path(folder) / "main.c").write_text(DRIVER.replace("NAME", name))
        define = [f"-D{name.upper()}_{flag}" for flag in flags]
        subprocess.run(["cc", "-std=gnu99", "-O2", *define, "main.c", f"{name}.c", "-lm", "-o", "axis"], cwd=folder,
                       check=True)
        return subprocess.run([pathlib.Path(folder) / "axis"], check=True, capture_output=True, text=True).stdout


print("| axis | double | float | float, events not located |\n|---|---|---|---|")
for axis in AXES:
    times = [step_time(axis, flags) for flags in ([], ["FLOAT=1"], ["FLOAT=1", "LOCATE_EVENTS=0"])]
    print(f"| `{axis.name}` | {' | '.join(times)} |", flush=True)
