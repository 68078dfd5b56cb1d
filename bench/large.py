#!/usr/bin/python3
"""large.py [BUILD] [SECONDS]: memory and processor time of checking and fitting a recording of so
many seconds at 1 kHz; 10,000 unless told, ten million rows."""
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
APPS = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "release") / "apps"
SECONDS = int(sys.argv[2]) if len(sys.argv) > 2 else 10_000
AXIS = ROOT / "configs" / "axes" / "x.yaml"
JOB = f"""axis: {AXIS}
recordings:
  - name: long
    file: long.csv
    time: {{column: time_s, unit: s}}
    signals:
      command: {{column: command_v, unit: V}}
      velocity: {{column: velocity_mps, unit: m/s, sigma: 2 mm/s}}
fit: {{observer: none}}
free:
  B_a: {{initial: 190 N s/m}}
  V_L: {{initial: 2.8 V}}
"""

with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    (folder / "motion.yaml").write_text(
        f"type: prbs\namplitude: 2 V\nbit: 0.2 s\nduration: {SECONDS} s\n", encoding="utf-8")
    (folder / "job.yaml").write_text(JOB, encoding="utf-8")
    subprocess.run([APPS / "simulate-axis", AXIS, folder / "motion.yaml", "--signals", "velocity",
                    "--output", folder / "long.csv"], check=True)
    size = (folder / "long.csv").stat().st_size
    print(f"{1000 * SECONDS + 1} rows, {size / 1e6:.0f} MB")
    for options in (["--check"], []):
        # One after the other, so that the memory is that of each alone.
        process = subprocess.Popen([APPS / "fit-params", folder / "job.yaml", *options],
                                   stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        print(f"{' '.join(options) or 'fit':<8} exit {os.waitstatus_to_exitcode(status)}"
              f" {usage.ru_utime + usage.ru_stime:>7.1f} s {usage.ru_maxrss / 1e3:>7.0f} MB,"
              f" {1024 * usage.ru_maxrss / size:.1f} times the file", flush=True)
