"""What the programs write, compared number by number."""

import itertools
import json
import math

TOLERANCE = 1e-9
ABSENT = "nothing"


def differences(one, other, where=""):
    """Where two pieces of JSON differ, numbers by more than the tolerance: 'PATH: ONE OTHER'."""
    if isinstance(one, dict) and isinstance(other, dict):
        pairs = ((key, one.get(key, ABSENT), other.get(key, ABSENT)) for key in one | other)
        return [d for key, a, b in pairs for d in differences(a, b, f"{where}/{key}")]
    if isinstance(one, list) and isinstance(other, list):
        pairs = enumerate(itertools.zip_longest(one, other, fillvalue=ABSENT))
        return [d for i, (a, b) in pairs for d in differences(a, b, f"{where}/{i}")]
    if type(one) is float and type(other) is float:
        equal = math.isclose(one, other, rel_tol=TOLERANCE)
    else:
        equal = one == other
    return [] if equal else [f"{where}: {str(one)[:100]} {str(other)[:100]}"]


def numbers(name, text):
    """The numbers of a text as JSON, or nothing where they are rounded."""
    if name.endswith("--exact"):
        return [[float(field) for field in line.split(",")] for line in text.splitlines()[1:]]
    if not name.endswith(("--json", ".json")):
        return None
    result = json.loads(text)
    for part in (result, *result.get("axes", {}).values()):
        for other in ("message", "axisfit", "wall_time_s", "work"):
            part.pop(other, None)
        # A rejected effect may have no minimum, and where its parameters stop is chance.
        part["effects"] = [e for e in part.get("effects", []) if e["decision"] != "rejected"]
    return result
