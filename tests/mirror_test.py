#!/usr/bin/env python3
"""Whether every source with code has a test of its name: X/Y/z.cpp or X/Y/z.h in tests/X/Y/z_test.*

A header has code if its functions return something. usage: mirror_test.py PROJECT
"""
import pathlib
import re
import sys

LAYERS = "base sim fit io exports init report fleet apps".split()

# Sources, or all of a folder, without a test of their name, and what tests them instead.
EXCEPTIONS = {
    "base/embedded.h": "a macro; the files that are embedded are tested",
    "sim/affine.h": "tests/sim/integrator_test.cpp: affine steps against the Runge-Kutta method",
    "sim/channel.h": "tests/sim/effects/channel_effect_test.cpp: Channels",
    "sim/controller_settings.h": "tests/sim/controller_test.cpp",
    "sim/equations.h": "tests/sim/paper_test.cpp, linear_test.cpp, derivative_test.cpp",
    "sim/mode.h": "tests/sim/guards_test.cpp: GuardValues",
    "sim/quantity.h": "tests/sim/model_test.cpp: QuantityList",
    "sim/sampling.h": "one division",
    "sim/scalar.h": "tests/sim/derivative_test.cpp, fit/solve/jet.h",
    "sim/signal.h": "tests/sim/vocabulary_test.cpp",
    "sim/simulate.h": "tests/sim/event_test.cpp and nearly every other of the layer",
    "sim/effects/": "tests/sim/force_law_test.cpp, and effects_test.cpp of every effect",
    "fit/errors/parameter_result.h": "one loop",
    "exports/fmu/fmi2.cpp": "tests/exports/fmu/fmu_test.cpp, through the library of an FMU",
    "exports/fmu/fmi3.cpp": "tests/exports/fmu/fmu_test.cpp, through the library of an FMU",
    "apps/axisfit_export.cpp": "a program: tests/apps/command_line_test.cpp",
    "apps/axisfit_fleet.cpp": "a program: tests/fleet/slurm_test",
    "apps/first_job.cpp": "tests/apps/command_line_test.cpp: AJobIsMadeForRecordings",
    "apps/fit_params.cpp": "a program: tests/apps/command_line_test.cpp",
    "apps/simulate_axis.cpp": "a program: tests/apps/command_line_test.cpp",
    "apps/simulate_fleet.cpp": "a program: tests/fleet/slurm_test",
    "apps/update_reference.cpp": "tests/io/config/reference_test.cpp",
}


def has_code(path):
    if path.suffix == ".cpp":
        return True
    if path.with_suffix(".cpp").exists():
        return False
    text = re.sub(r"//.*|\"(\\.|[^\"\\])*\"", "", path.read_text(encoding="utf-8"))
    return re.search(r"\breturn\b", text) is not None


def has_test(project, name):
    tests = project / "tests" / pathlib.Path(name).parent
    stem = pathlib.Path(name).stem
    return any(tests.glob(f"{stem}_test*")) or any(tests.glob(f"{stem}_slow_test*"))


def main():
    project = pathlib.Path(sys.argv[1])
    sources = [
        path.relative_to(project).as_posix()
        for layer in LAYERS
        for path in sorted((project / layer).rglob("*"))
        if path.suffix in (".h", ".cpp") and has_code(path)
    ]
    untested = [name for name in sources if not has_test(project, name)]
    def covers(entry, name):
        return name == entry or (entry.endswith("/") and name.startswith(entry))

    wrong = [
        f"{name} has no test of its name: add tests/{name.rsplit('.', 1)[0]}_test.cpp"
        for name in untested
        if not any(covers(entry, name) for entry in EXCEPTIONS)
    ]
    wrong += [
        f"{entry} needs no exception any more: remove it from {pathlib.Path(__file__).name}"
        for entry in EXCEPTIONS
        if not any(covers(entry, name) for name in untested)
    ]
    print("\n".join(wrong) if wrong else f"{len(sources) - len(untested)} sources have a test of their name")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
