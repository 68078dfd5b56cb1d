#!/usr/bin/python3
"""run.py [BUILD] [--cases N] [--clean N] [--kinds ...] [--methods ...] [--seed N]: the search for missing
effects beside sparse regression, on simulations that are not the project's (generator.py) and on two
measured machines (measured.py, skipped with a line that says so where their folders are absent).

How a case is judged. What a method claims are the effects that it accepts, or those of the terms that it
selects. A claim is good if it is the law that was simulated or its nearest relative, as kinds.py lists
them; all other claims are wrong structure. A case is
- `right` if every law that is missing has a good claim, and nothing is wrong,
- `partly` if some have, and nothing is wrong,
- `undecided` if nothing is added, but a good claim is named as one of several that explain as much,
- `missed` if nothing is claimed,
- `mixed` if good and wrong claims stand side by side,
- `wrong` if all claims are.
A clean case (half of them have coloured force noise) is `right` if nothing is claimed, and a false
acceptance otherwise; the upper limit is that of the 95 % interval of Clopper and Pearson. A law that the
catalogue does not have is right if nothing is claimed.

The error is the same for all: the rms, up to 20 Hz and where the axis moves, of the drive force less the one
that the model predicts for the motion of a recording that no method has seen. The generator knows that motion
exactly, so that the law itself has no error; signals of a measured machine are filtered first. What is taken
of the force, by a droop or by friction, is taken of the predicted one: a term of the recorded force may explain
that force by itself. The error is shown over that of the declared model, fitted by least squares. Times are
processor time of one thread; with --threads N, which wants --jobs 1, those of axisfit are what N threads take.
Needs python3-numpy, python3-scipy and python3-sklearn."""
import argparse
import concurrent.futures
import dataclasses
import os
import pathlib
import sys
import tempfile
import time
import warnings

import numpy as np
from scipy import stats

import axisfit
import measured
import regression
from cases import CLEAN, NAMES, make, write
from kinds import KINDS

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
VERDICTS = ("right", "partly", "undecided", "missed", "mixed", "wrong")
NOTHING = "-"


@dataclasses.dataclass
class Answer:
    claims: list
    error: float  # N
    seconds: float
    undecided: tuple = ()
    note: str = ""


def by_regression(recordings, free, methods, mass=0.0):
    """The answers of the alternatives, and of the base terms alone under the name `declared`. The mass in
    kg is known where it is not free."""
    k = {role: regression.kinematics(r) for role, r in recordings.items()}
    begin = time.process_time()
    problem = regression.Problem(k["fit"], k["validate"], free, mass)
    library = time.process_time() - begin
    answers = {"declared": Answer([], regression.held_out(problem, [], k["test"]), 0.0)}
    for name in methods:
        begin = time.process_time()
        selected = regression.METHODS[name](problem)
        seconds = library + time.process_time() - begin
        claims = sorted({problem.effects[i] for i in selected})
        answers[name] = Answer(claims, regression.held_out(problem, selected, k["test"]), seconds)
    return answers


def by_axisfit(options, job, folder, test, arguments=(), declared=None):
    found = axisfit.run(options.program, job, folder, arguments, options.limit, options.threads)
    if found is None:
        return Answer([], np.nan, np.nan, note="failed")
    error = axisfit.held_out({**(declared or {}), **found.values}, test)
    return Answer(sorted(set(found.accepted)), error, found.seconds, tuple(found.undecided),
                  f"{found.grade}, chi-square {found.chi_square:.3g}")  # fmt: skip


def in_folder(keep, name, work):
    """Does the work in a folder that is kept or not."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(keep or temporary).resolve() / name
        folder.mkdir(parents=True, exist_ok=True)
        return work(folder)


def answer(label, case, options):
    """The answers of all methods on a case of the generator."""
    others = [m for m in options.methods if m != "axisfit"]
    answers = by_regression(case.recordings, case.free, others, case.base.mass)
    if "axisfit" in options.methods:

        def work(folder):
            write(case, folder, options.horizon, options.free_run)
            return by_axisfit(options, folder / "job.yaml", folder, case.recordings["test"],
                              declared={"M": case.base.mass})  # fmt: skip

        answers["axisfit"] = in_folder(options.keep, label, work)
    return answers


def judge(case, given):
    """One of VERDICTS."""
    laws = [KINDS[p] for p in case.parts]
    known = [law for law in laws if law.counts]
    good = set().union(*(law.counts for law in laws))
    # quadratic_drag.n is more of quadratic_drag
    wrong = [c for c in given.claims if not {c, c.rpartition(".")[0]} & good]
    named = sum(bool(law.counts & set(given.claims)) for law in known)
    if wrong:
        return "mixed" if named else "wrong"
    if named == len(known):
        return "right"
    if named:
        return "partly"
    return "undecided" if good & set(given.undecided) else "missed"


def upper_limit(wrong, count):
    return 1.0 if wrong == count else float(stats.beta.ppf(0.975, wrong + 1, count - wrong))


def ratio(answers, name):
    return answers[name].error / answers["declared"].error


def print_summary(results, methods):
    print("| method | " + " | ".join(VERDICTS) + " | false acceptances | upper limit | error |"
          " axisfit ahead | s, median | s, longest |")  # fmt: skip
    print("|---" * (len(VERDICTS) + 7) + "|")
    lacking = [(c, a) for _, c, a in results if c.name not in CLEAN]
    clean = [(c, a) for _, c, a in results if c.name in CLEAN]
    for name in methods:
        verdicts = [judge(c, a[name]) for c, a in lacking]
        counts = " | ".join(str(verdicts.count(v)) for v in VERDICTS)
        accepted = sum(bool(a[name].claims) for _, a in clean)
        limit = f"{100 * upper_limit(accepted, len(clean)):.1f} %" if clean else NOTHING
        errors = [ratio(a, name) for _, a in lacking]
        error = f"{np.nanmedian(errors):.2f}" if np.any(np.isfinite(errors)) else NOTHING
        ahead = NOTHING
        if name != "axisfit" and "axisfit" in methods:
            ahead = f"{sum(a['axisfit'].error <= a[name].error for _, a in lacking)} of {len(lacking)}"
        seconds = [a[name].seconds for _, _, a in results]
        print(f"| {name} | {counts} | {accepted} of {len(clean)} | {limit} | {error} | {ahead} | "
              f"{np.nanmedian(seconds):.1f} | {np.nanmax(seconds):.1f} |")  # fmt: skip


def told(name, given):
    """What a cell says of the claims: all of axisfit's, a number of others where there are many."""
    claims = " ".join(given.claims) or NOTHING
    if name != "axisfit" and len(given.claims) > 3:
        claims = f"{len(given.claims)} effects"
    return claims + (f" (or {', '.join(given.undecided)})" if given.undecided else "")


def print_cases(results, methods):
    print("| case | driven by | " + " | ".join(methods) + " | axisfit says |")
    print("|---" * (len(methods) + 3) + "|")
    for label, case, answers in results:
        cells = [f"{judge(case, answers[m])}: {told(m, answers[m])}, {ratio(answers, m):.2f}"
                 for m in methods]  # fmt: skip
        own = answers.get("axisfit")
        note = f"{own.note}, {own.seconds:.1f} s" if own else ""
        print(f"| {label} | {case.setup} | " + " | ".join(cells) + f" | {note} |")


def print_measured(options):
    found, absent = measured.available(options.data, ROOT)
    for name in absent:
        print(f"{name}: skipped, no folder of that name in the folder of --data.\n")
    for case in found:
        others = [m for m in options.methods if m != "axisfit"]
        answers = by_regression(case.recordings, case.free, others)
        if "axisfit" in options.methods:
            answers["axisfit"] = in_folder(options.keep, case.name, lambda folder: by_axisfit(
                options, case.job(folder), folder, case.recordings["test"],
                case.arguments))  # fmt: skip
        unit = "N" if case.name == "EMPS" else "N m"
        print(f"## {case.name}\n\n| method | error, {unit} | s | claims |\n|---|---|---|---|")
        for name in ("declared", *options.methods):
            a = answers[name]
            print(f"| {name} | {a.error:.4g} | {a.seconds:.1f} | {told('axisfit', a)} |", flush=True)
        print()


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("build", nargs="?", type=pathlib.Path, default=ROOT / "build" / "release")
    parser.add_argument("--cases", type=int, default=4, help="of each kind")
    parser.add_argument("--clean", type=int, help="clean cases of each kind, otherwise as --cases")
    parser.add_argument("--kinds", nargs="*", choices=NAMES, default=NAMES, metavar="KIND")
    methods = ("axisfit", *regression.METHODS)
    parser.add_argument("--methods", nargs="+", choices=methods, default=methods, metavar="METHOD")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--chi-square", type=float, nargs="+", default=(3.0, 10.0),
                        help="of the fit without the law; cases take them in turn")  # fmt: skip
    parser.add_argument("--free-run", action="store_true", help="fits of servos without an observer")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="cases at the same time")
    parser.add_argument("--horizon", default="whole", help="of axisfit's fits without an observer")
    parser.add_argument("--threads", type=int, default=1, help="of each run of axisfit")
    parser.add_argument("--limit", type=int, default=900, help="s, of one run of axisfit")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for the files of all cases")
    parser.add_argument("--no-measured", action="store_true", help="without EMPS and BAM")
    parser.add_argument("--data", type=pathlib.Path, default=ROOT.parent / "shared" / "data",
                        help="folder with emps and bam, which are not part of the project")  # fmt: skip
    options = parser.parse_args()
    options.program = (options.build / "apps" / "fit-params").resolve()
    options.data = options.data.resolve()
    return options


def main():
    options = arguments()
    warnings.filterwarnings("ignore", module="sklearn")  # of a lasso that has not converged quite
    names = [n for n in options.kinds if n not in CLEAN]
    clean = [n for n in options.kinds if n in CLEAN]
    drawn = options.seed, options.chi_square
    cases = make(names, options.cases, *drawn) if names else []
    count = options.cases if options.clean is None else options.clean
    cases += make(clean, count, *drawn) if clean and count else []
    labels = [f"{c.name} {sum(o.name == c.name for o in cases[:i])}" for i, c in enumerate(cases)]
    print(f"`bench/alternatives/run.py {' '.join(sys.argv[1:])}`\n")
    if cases:
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            answers = pool.map(lambda x: answer(*x, options), zip(labels, cases))
            results = list(zip(labels, cases, answers))
        print_summary(results, options.methods)
        print("\nEach cell: verdict, claims, error over that of the declared model.\n")
        print_cases(results, options.methods)
        print(flush=True)
    if not options.no_measured:
        print_measured(options)


if __name__ == "__main__":
    main()
