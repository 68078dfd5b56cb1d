#!/usr/bin/python3
"""counts.py [--update] COUNTS RECORD: fails when a count of the program COUNTS, or the number of
instructions that callgrind sees, is more than a tenth above that in the file RECORD. Where one is
more than a tenth below, it says that the record should be brought up to date, by --update."""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ALLOWED = 0.1
SKIPPED = 77


def counts(program):
    lines = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    return {name: int(value) for name, value in map(str.split, lines.splitlines())}


def instructions(program, work):
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run(
            ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out", program, work],
            check=True, capture_output=True, text=True)
    return int(re.search(r"Collected : (\d+)", run.stderr).group(1))


def main():
    *options, program, record = sys.argv[1:]
    if shutil.which("valgrind") is None:
        print("skipped: valgrind is not installed")
        return SKIPPED
    found = counts(program)
    idle = instructions(program, "none")
    for work in ("step", "held"):
        found[f"{work}.instructions"] = instructions(program, work) - idle
    path = pathlib.Path(record)
    if options == ["--update"]:
        path.write_text(json.dumps(dict(sorted(found.items())), indent=2) + "\n", encoding="utf-8")
        return 0
    known = json.loads(path.read_text(encoding="utf-8"))
    if found.keys() != known.keys():
        print("not the same counts:", sorted(found.keys() ^ known.keys()))
        return 1
    wrong = 0
    for name, value in sorted(found.items()):
        change = value / known[name] - 1.0
        verdict = "more" if change > ALLOWED else "less: --update" if change < -ALLOWED else ""
        wrong += change > ALLOWED
        print(f"{name:<20} {value:>12} {known[name]:>12} {100 * change:>+7.1f} % {verdict}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
