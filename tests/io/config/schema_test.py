#!/usr/bin/env python3
"""Do the schemas in configs/schema and the programs agree?

    schema_test.py PROJECT BIN

Every example below configs/ must validate against the schema that its first line names; every file
that is wrong in a way a schema can see must fail there, and in the program that reads it.
"""

import pathlib
import re
import subprocess
import sys
import tempfile

try:
    import jsonschema
    import yaml
except ImportError as error:
    print(f"skipped: {error}; scripts/install-dependencies installs it")
    sys.exit(77)

PROJECT, BIN = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
CONFIGS = PROJECT / "configs"


class Yaml12(yaml.SafeLoader):
    """YAML 1.2, as editors read it: `yes` is a text and 5e6 a number."""


Yaml12.yaml_implicit_resolvers = {}
for tag, pattern, first in [
    ("bool", r"true|false", "tf"),
    ("null", r"null|~|", ["n", "~", ""]),
    ("int", r"[-+]?[0-9]+", "-+0123456789"),
    ("float", r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?", "-+.0123456789"),
]:
    Yaml12.add_implicit_resolver(f"tag:yaml.org,2002:{tag}", re.compile(f"^(?:{pattern})$"), first)


def validator(schema_file):
    schema = yaml.load(schema_file.read_text(), Yaml12)
    jsonschema.Draft7Validator.check_schema(schema)
    return jsonschema.Draft7Validator(schema)


VALIDATORS = {
    kind: validator(CONFIGS / "schema" / f"{kind}.schema.json")
    for kind in ("job", "axis", "motion", "machine")
}


def mistakes(kind, text):
    """The places and messages of what the schema finds, as one text."""
    found = VALIDATORS[kind].iter_errors(yaml.load(text, Yaml12))
    return "\n".join(f"{e.json_path}: {e.message}"[:300] for e in found)


def refusal(kind, text):
    """What the program says of the file; empty when it takes it."""
    with tempfile.TemporaryDirectory() as folder:
        # Beside the examples, as far as their relative paths go.
        (pathlib.Path(folder) / "configs").symlink_to(CONFIGS)
        (pathlib.Path(folder) / "testdata").symlink_to(PROJECT / "testdata")
        file = pathlib.Path(folder) / "file.yaml"
        file.write_text(text.replace("../../", "").replace("../", "configs/"))
        x_axis = CONFIGS / "axes" / "x.yaml"
        step = CONFIGS / "motions" / "step.yaml"
        command = {
            "job": ["fit-params", file, "--check", "--quiet"],
            "axis": ["simulate-axis", file, step],
            "motion": ["simulate-axis", x_axis, file],
            "machine": ["simulate-axis", file, "--output", pathlib.Path(folder) / "out", "--rate", "100"],
        }[kind]
        run = subprocess.run([BIN / command[0], *command[1:]], capture_output=True, text=True)
        assert run.returncode in (0, 2), run
        return run.stderr if run.returncode == 2 else ""


def example(kind, name):
    return (CONFIGS / {"job": "jobs", "axis": "axes", "motion": "motions", "machine": "machines"}[kind] / name).read_text()


# kind, example, what to replace in it, and by what
RIGHT = [
    ("job", "paper.yaml", "B_a: {initial: 60 N s/m}", "B_a:"),
    ("job", "paper.yaml", "B_a: {initial: 60 N s/m}", "B_a: {initial: 60N s/m, bounds: [.4 N s/m, 1e3 N s/m]}"),
    ("job", "paper.yaml", "sigma: 2 mm/s", "sigma: standstill, factor: 50 %, sign: -1"),
    ("job", "paper.yaml", "free:", "fit: {observer: {fixed: 5 1/ms}, step: 1 ms, starts: 2}\nfree:"),
    ("job", "paper.yaml", "free:", "effects: {coulomb_friction: {F_c: 0 N}}\nlimits: {travel: [0 m, +1.2 m]}\nfree:"),
    ("axis", "x.yaml", "K_v: 1000 ", "K_v: 1e3 "),
    ("axis", "x.yaml", "K_v: 1000 ", "K_v: 100000 % "),
    ("axis", "x.yaml", "H: 0.01 mm", "H: 10 µm"),
    ("motion", "prbs.yaml", "seed: 1", "offset: -1 V"),
    ("machine", "robot.yaml", "y_acceleration: -2.2 N/(m/s^2)", "y_acceleration: -2.2 kg"),
    ("axis", "x.yaml", "parameters:", "channels: {oil: {unit: degC, zero: 20 degC}}\n"
     "effects: {channel_friction: {oil: -1 N/K}, channel_gain: {oil: 0.01 1/K}}\nparameters:"),
    ("job", "channels.yaml", "free:", "effects: {channel_force: {supply: 1 N/V}}\nfree:\n  channel_force.supply: {}"),
    ("axis", "pendulum.yaml", "J: 24 g m^2", "J: 0.024 kg m^2"),
    # a lead instead of a radius; several axes
    ("axis", "x.yaml", "r_g: 5.73 mm", "lead: 36 mm"),
    ("job", "three-axes.yaml", "three-axes/", "configs/jobs/three-axes/"),
]

WRONG = [
    # an unknown key
    ("job", "paper.yaml", "free:", "colour: red\nfree:"),
    ("job", "paper.yaml", "  - name: step", "  - nam: step"),
    ("job", "paper.yaml", "sigma: 2 mm/s", "sgima: 2 mm/s"),
    ("job", "paper.yaml", "B_a: {initial", "B_q: {initial"),
    ("job", "paper.yaml", "B_a: {initial", "B_a: {intial"),
    ("job", "paper.yaml", "free:", "effects: {quadratic_darg: {c: 3 N s^2/m^2}}\nfree:"),
    ("axis", "x.yaml", "  M: 146 kg", "  M: 146 kg\n  mass: 146 kg"),
    ("axis", "x.yaml", "period: 5 ms", "perod: 5 ms"),
    ("axis", "x.yaml", "r_g: 5.73 mm", "r_g: 5.73 mm\n  lead: 36 mm"),
    ("axis", "x.yaml", "r_g: 5.73 mm", "gear_ratio: 5"),
    ("job", "three-axes.yaml", "  x: three-axes/x.yaml\n  y: three-axes/y.yaml\n", ""),
    ("motion", "step.yaml", "level: 10 V", "level: 10 V\namplitude: 1 V"),
    # the words of a load that slides
    ("axis", "pendulum.yaml", "J: 24 g m^2", "M: 24 kg"),
    ("axis", "pendulum.yaml", "T_c: 0.08 N m", "F_c: 0.08 N"),
    ("axis", "pendulum.yaml", "torque_source", "force_source"),
    ("axis", "pendulum.yaml", "joint: revolute", "joint: prismatic"),
    # a required key that is missing
    ("job", "paper.yaml", "axis: ../axes/x.yaml\n", ""),
    ("job", "paper.yaml", "{column: time_s, unit: s}", "{column: time_s}"),
    ("job", "paper.yaml", "free:", "effects: {coulomb_friction: {}}\nfree:"),
    ("job", "paper.yaml", "{initial: 60 N s/m}", "{prior: {mean: 60 N s/m}}"),
    ("axis", "x.yaml", "drive: velocity_loop\n", ""),
    ("axis", "x.yaml", "  R: 0.56 ohm\n", ""),
    ("axis", "emps.yaml", "  K_f: 35.15065188248547 N/V", "  # none"),
    ("motion", "step.yaml", "duration: 2.5 s\n", ""),
    ("motion", "chirp.yaml", "to: 60 Hz\n", ""),
    # a choice that there is not
    ("job", "paper.yaml", "  - name: step", "  - role: fitt"),
    ("job", "paper.yaml", "sigma: 2 mm/s", "sign: 2"),
    ("job", "paper.yaml", "sigma: 2 mm/s", "sigma: guess"),
    ("job", "paper.yaml", "free:", "fit: {observer: loose}\nfree:"),
    ("axis", "x.yaml", "drive: velocity_loop", "drive: velocty_loop"),
    ("motion", "step.yaml", "type: step", "type: stop"),
    ("machine", "robot.yaml", "    motion: ../motions/move.yaml\n", ""),
    ("machine", "robot.yaml", "    channels: {y_position:", "    channel: {y_position:"),
    ("job", "channels.yaml", "temperature: {column: temperature_degc, unit: degC}", "temperature: {column: temperature_degc}"),
    # a value of the wrong kind, or beyond the range of a number
    ("job", "paper.yaml", "axis: ../axes/x.yaml", "axis: [../axes/x.yaml]"),
    ("job", "paper.yaml", "  - name: step", "  - score_initial_samples: no"),
    ("job", "paper.yaml", "  - name: step", "  - initial_samples: 3"),
    ("job", "paper.yaml", "free:", "fit: {starts: 1.5}\nfree:"),
    ("job", "paper.yaml", "free:", "fit: {spread: 0.5}\nfree:"),
    ("job", "paper.yaml", "{initial: 60 N s/m}", "{bounds: 60 N s/m}"),
    ("job", "paper.yaml", "{initial: 60 N s/m}", "{bounds: [60 N s/m]}"),
    ("axis", "x.yaml", "K_v: 1000 ", "K_v: 1 "),
    ("axis", "x.yaml", "K_v: 1000 ", "K_v: 10 kg "),
    ("motion", "levels.yaml", "levels: [8 V, -4.8 V, 2.4 V, -8 V, 6.4 V, 0 V]", "levels: []"),
    # a unit that is missing, and numbers that can be misunderstood
    ("job", "paper.yaml", "{initial: 60 N s/m}", "{initial: 60}"),
    ("job", "paper.yaml", "sigma: 2 mm/s", "sigma: 0.002"),
    ("axis", "x.yaml", "k_g: 5e6 N/m", "k_g: 5e6"),
    ("axis", "x.yaml", "k_g: 5e6 N/m", "k_g: '5e6'"),
    ("axis", "x.yaml", "M: 146 kg", "M: 0146 kg"),
    ("axis", "x.yaml", "M: 146 kg", "M: 146,5 kg"),
    ("axis", "x.yaml", "M: 146 kg", "M: kg"),
    ("axis", "x.yaml", "M: 146 kg", "M: 1_000 kg"),
    ("motion", "step.yaml", "level: 10 V", "level: 10"),
    # what the drive and the transmission leave out
    ("axis", "x.yaml", "  M: 146 kg", "  M: 146 kg\n  K_f: 35 N/V"),
    ("axis", "emps.yaml", "constant_force: {F_0: 0 N}", "torque_droop: {c_i: 0 1/A}"),
    ("axis", "emps.yaml", "effects:", "initial: {y6: 1 A}\neffects:"),
]


def changed(kind, name, old, new):
    text = example(kind, name)
    assert text.count(old) >= 1, f"{name} has no '{old}'"
    return text.replace(old, new, 1)


failures = []


def expect(condition, what):
    if not condition:
        failures.append(what)


examples = sorted(CONFIGS.rglob("*.yaml"))
expect(len(examples) >= 20, "there are fewer examples than there were")
for file in examples:
    text = file.read_text()
    named = re.match(r"# yaml-language-server: \$schema=(\S+)\n", text)
    schema = (file.parent / named[1]).resolve() if named else None
    expect(schema and schema.is_file(), f"{file}: the first line does not name its schema")
    if schema and schema.is_file():
        found = mistakes(schema.name.split(".")[0], text)
        expect(not found, f"{file}: {found}")

for case in RIGHT:
    text = changed(*case)
    found, said = mistakes(case[0], text), refusal(case[0], text)
    expect(not found, f"{case[3]!r} in {case[1]} is refused by the schema: {found}")
    expect(not said, f"{case[3]!r} in {case[1]} is refused by the program: {said}")

for case in WRONG:
    text = changed(*case)
    expect(mistakes(case[0], text), f"{case[3]!r} in {case[1]} passes the schema")
    expect(refusal(case[0], text), f"{case[3]!r} in {case[1]} passes the program")

print("\n".join(failures) or f"{len(examples)} examples, {len(RIGHT)} right, {len(WRONG)} wrong files")
sys.exit(1 if failures else 0)
