#!/usr/bin/env python3
"""Do two builds find the same in the example jobs?

    same_result.py BIN OTHER [--slow] [JOB...]

Compares what the programs in the folders BIN and OTHER write to result.json: numbers within 1e-9;
names, decisions and grades exactly; neither sentences nor rejected effects. Of a difference, it
shows first what OTHER finds. JOB is a name in configs/jobs, without .yaml. Without --slow, all jobs
take two minutes of processor time for each side; those that --slow adds take minutes each.
Recordings outside the project are looked for in the folders that AXISFIT_EMPS and AXISFIT_BAM
name, or in ../shared/data.
"""

import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from answers import differences, numbers

PROJECT = pathlib.Path(__file__).resolve().parents[2]
SHOWN = 5  # differences of a job

# The options of each run of a job; a job that is not listed runs once without any.
OPTIONS = {
    "channels": ["--close-loop"],
    "close-loop": ["", "--close-loop --predict --compare"],
    "emps": ["--predict"],
    "emps-close-loop": ["--close-loop"],
    "emps-train": ["--close-loop"],
    "paper": ["--starts=4 --profile", "--close-loop"],
    "paper-slow-near": ["--suggest-experiment"],
    "payload": ["", "--close-loop"],
    "screw-bent": ["--close-loop --suggest-experiment"],
    "screw-viscous": ["--close-loop"],
    "three-axes": ["--close-loop"],
}
SLOW = re.compile("bam-|emps-train")
# What runs before a job: here it records the motion that is suggested for another job.
BEFORE = {
    "paper-slow-next": [
        "fit-params configs/jobs/paper-slow-near.yaml --suggest-experiment --output results",
        "simulate-axis configs/axes/x.yaml results/next-motion.yaml --seed 7"
        " --output results/next.csv",
    ],
}
SENTENCES = re.compile(
    r"/(message|meaning|reason|description|text|warnings|hints)(/\d+)?: "
    r"|/assumptions/(residuals|model): |/next_experiment/motion: "
    r"|^(/axes/[^/]+)?(/selection)?/verdict: "
)


class Side:
    """The programs of a build, and a folder with the jobs of this work tree."""

    def __init__(self, programs, folder):
        self.programs, self.folder = programs.resolve(), folder
        shutil.copytree(PROJECT / "configs", folder / "configs")
        (folder / "testdata").symlink_to(PROJECT / "testdata")

    def run(self, program, *arguments):
        return subprocess.run([self.programs / program, *arguments], cwd=self.folder,
                              capture_output=True, text=True)  # fmt: skip

    def fit(self, job, *options):
        """The result of a job, or why there is none."""
        for command in BEFORE.get(job, []):
            self.run(*command.split())
        done = self.run("fit-params", f"configs/jobs/{job}.yaml", *options, "--json")
        if done.returncode in (0, 3):
            return numbers("--json", done.stdout), None
        return None, f"exit code {done.returncode}, {done.stderr.strip()}"


def data_of(job):
    """The folder of the recordings of a job, or nothing where the project has them."""
    source = job.split("-")[0]
    if source not in ("bam", "emps"):
        return None
    given = os.environ.get(f"AXISFIT_{source.upper()}")
    return pathlib.Path(given or PROJECT.parent / "shared/data" / source).resolve()


def compare(one, other, job, options):
    """Whether a run is 'same', 'differs' or 'skipped', and what to say about that."""
    if data := data_of(job):
        text = (PROJECT / f"configs/jobs/{job}.yaml").read_text()
        for file in re.findall(r"\bfile: (\S+)", text):
            if not (data / file).exists():
                return "skipped", f": {data / file} is missing"
        options = [*options, "--data", data]
    (expected, no_other), (result, no_result) = other.fit(job, *options), one.fit(job, *options)
    if no_result:
        return "differs", f"\n  no result: {no_result}"
    if no_other:
        return "skipped", f": the other programs have no result: {no_other}"
    found = [d for d in differences(expected, result) if not SENTENCES.search(d)]
    if not found:
        return "same", ""
    lines = [f"\n  {difference}" for difference in found[:SHOWN]]
    return "differs", "".join(lines) + f"\n  {len(found)} differences" * (len(found) > SHOWN)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bin", type=pathlib.Path)
    parser.add_argument("other", type=pathlib.Path)
    parser.add_argument("jobs", nargs="*", metavar="JOB")
    parser.add_argument("--slow", action="store_true", help="also the jobs that take minutes each")
    asked = parser.parse_intermixed_args()

    known = sorted(path.stem for path in PROJECT.glob("configs/jobs/*.yaml"))
    if unknown := set(asked.jobs) - set(known):
        parser.error(f"there is no job {', '.join(sorted(unknown))}")
    count = dict.fromkeys(("same", "differs", "skipped"), 0)
    with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as other:
        sides = Side(asked.bin, pathlib.Path(one)), Side(asked.other, pathlib.Path(other))
        for job in asked.jobs or known:
            for options in OPTIONS.get(job, [""]):
                if SLOW.match(job) and not asked.slow:
                    outcome, remark = "skipped", ": it is slow, and runs with --slow"
                else:
                    outcome, remark = compare(*sides, job, options.split())
                count[outcome] += 1
                print(f"{outcome:8} {job} {options}".rstrip() + remark, flush=True,
                      file=sys.stderr if outcome == "skipped" else sys.stdout)  # fmt: skip
    print("{same} passed, {differs} failed, {skipped} skipped".format(**count))
    return 1 if count["differs"] else 0


if __name__ == "__main__":
    sys.exit(main())
