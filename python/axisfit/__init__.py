"""Parameters of a machine's axis from recordings of its motion, with error bars, and the physical effects that its
model lacks.

    import axisfit
    job = axisfit.Job(axis="axis.yaml", free=["M", "B_a"],
                      recordings=[axisfit.Recording(frame, time="t", units={"t": "s", "u": "V", "v": "m/s"},
                                                    signals={"command": "u", "velocity": "v"})])
    result = axisfit.fit(job)
    result.parameters      # a DataFrame where pandas is installed
    result.save("results") # the files of fit-params

Everything does what the programs fit-params and simulate-axis do, with the same digits; docs/python.md tells of it.
"""
import json as _json
import os as _os
import sys as _sys

import numpy as _numpy

from . import _core
from ._core import JobError, __version__
from ._plot import Plots

__all__ = ["Axis", "Job", "JobError", "Recording", "Result", "__version__", "close_loop", "fit", "init", "predict",
           "profile", "simulate", "suggest_experiment"]


def _frame(columns, index=None):
    """A DataFrame of columns, or the dict itself without pandas."""
    try:
        import pandas
    except ImportError:
        return columns
    frame = pandas.DataFrame(columns)
    return frame.set_index(index) if index else frame


def _csv(text):
    """The columns of a CSV that axisfit wrote, empty fields as NaN."""
    head, *rows = text.rstrip("\n").split("\n")
    values = [[float(field) if field else float("nan") for field in row.split(",")] for row in rows]
    columns = _numpy.array(values, dtype=float).reshape(len(rows), -1).T
    return _frame(dict(zip(head.split(","), columns)))


def _read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


class Axis:
    """An axis: the text of an axis file (docs/axis-file.md), from a file, a dict or YAML."""

    def __init__(self, source):
        """`source`: a path, a dict as the axis file has it, or an Axis."""
        if isinstance(source, Axis):
            self.name, self.text = source.name, source.text
        elif isinstance(source, (str, _os.PathLike)):
            self.name, self.text = _os.fspath(source), _read(source)
        else:
            self.name, self.text = "axis.yaml", _json.dumps(source, indent=1, ensure_ascii=False)

    @classmethod
    def from_yaml(cls, text):
        """From the text of an axis file."""
        axis = cls({})
        axis.text = text
        return axis

    def __repr__(self):
        return f"<axisfit.Axis {self.name}>"


class Recording:
    """A recording for a job: columns from numpy arrays, a DataFrame or a file, and what they are.

    data: a dict of one-dimensional arrays by name, a DataFrame, or the path of a file (CSV, MAT, MCAP, XLSX).
    time: the column of the times, increasing. signals: a dict of the input (`command`, `current`, `force`, ...) and the
    measured signals to columns. units: a dict of columns to units, such as {"t": "ms", "x": "mm"}; a column may as well
    be {"column": "x", "unit": "mm", "sign": -1}. role: "fit" or "validate". Further keywords are keys of a recording in
    a job file (docs/job-file.md), such as trim={"from": "1 s"}.
    """

    def __init__(self, data, *, time, signals, units=None, role="fit", name=None, **keys):
        self._units = dict(units or {})
        self.columns = None
        self.file = None
        if isinstance(data, (str, _os.PathLike)):
            self.file = _os.fspath(data)
        else:
            self.columns = {str(column): _column(column, data[column]) for column in data}
        self.name = name
        self.entry = {"role": role, "time": self._described(time),
                      "signals": {signal: self._described(column) for signal, column in signals.items()}, **keys}
        if name:
            self.entry["name"] = name

    def _described(self, column):
        if isinstance(column, dict):
            return column
        if column not in self._units:
            raise ValueError(f"column {column!r} has no unit: add it to units, as in units={{{column!r}: 's'}}")
        return {"column": column, "unit": self._units[column]}


def _column(name, values):
    array = _numpy.asarray(getattr(values, "values", values))
    if array.dtype.kind not in "fiub":
        raise TypeError(f"column {name!r} holds {array.dtype}, not numbers")
    return _numpy.ascontiguousarray(array, dtype=float)  # the same memory, if it is that already


class Job:
    """What to fit to which recordings (docs/job-file.md).

    axis: a path, a dict, or an Axis. recordings: a list of Recording. free: names of quantities, or a dict of them to
    what a job file says of each, such as {"M": {}, "B_a": {"initial": "100 N s/m"}}. effects, fit and limits: dicts, as
    in a job file. Raises JobError, whose `diagnostics` are (file, line, column, message).
    """

    def __init__(self, axis, recordings, free, effects=None, fit=None, limits=None):
        axis = Axis(axis)
        entries, tables = [], {}
        for number, recording in enumerate(recordings, 1):
            entry = dict(recording.entry)
            if recording.columns is None:
                entry["file"] = _os.path.abspath(recording.file)
            else:
                entry["file"] = recording.name or f"recording-{number}"
                if entry["file"] in tables:
                    raise ValueError(f"two recordings are called {entry['file']!r}: give them different names")
                entry.setdefault("name", entry["file"])
                tables[entry["file"]] = recording.columns
            entries.append(entry)
        job = {"axis": "axis.yaml", "recordings": entries,
               "free": free if isinstance(free, dict) else {name: {} for name in free}}
        job.update({key: value for key, value in (("effects", effects), ("fit", fit), ("limits", limits)) if value})
        files = [("axis.yaml", axis.text), ("job.yaml", _json.dumps(job, indent=1, ensure_ascii=False))]
        self._core = _core.make_job(files, ".", tables)

    @classmethod
    def from_file(cls, path, data=None):
        """Reads a job file; recordings with relative paths are in the folder `data`, or beside the job."""
        job = cls.__new__(cls)
        job._core = _core.read_job(_os.fspath(path), _os.fspath(data or ""))
        return job

    @classmethod
    def from_yaml(cls, text, folder="."):
        """From the text of a job file, as if it stood in the folder."""
        job = cls.__new__(cls)
        job._core = _core.make_job([("job.yaml", text)], _os.fspath(folder), {})
        return job

    @property
    def free(self):
        """Names of the free parameters."""
        return list(self._core.names)

    @property
    def axis(self):
        """The axis as declared."""
        axis = Axis.from_yaml(self._core.axis_text)
        axis.name = self._core.axis_file
        return axis

    def __repr__(self):
        return f"<axisfit.Job of {', '.join(self._core.recordings)}: {', '.join(self.free)}>"


class Result:
    """What a fit found. All of result.json stands in `json` (docs/result.md)."""

    def __init__(self, core):
        self._core = core
        self.json = _json.loads(core.json)
        self.plot = Plots(self)

    @property
    def usable(self):
        """Whether the fit can be relied on for what it says."""
        return self.json["usable"]

    @property
    def grade(self):
        """"explained", "usable", "model_wrong", "nothing_determined" or "not_converged"."""
        return self.json["grade"]

    @property
    def verdict(self):
        """The grade and its reason, a sentence."""
        return self.json["verdict"]

    @property
    def interrupted(self):
        """Whether it was stopped before all that was asked for was finished."""
        return self.json["interrupted"]

    @property
    def parameters(self):
        """Name (index), value, standard_error, lower and upper end of the 95 % interval, unit, verdict."""
        nan = float("nan")
        rows = self.json["parameters"]
        interval = [row["confidence_interval"] or [nan, nan] for row in rows]
        return _frame({"name": [row["name"] for row in rows],
                       "value": _numpy.array([row["value"] for row in rows], dtype=float),
                       "standard_error": _numpy.array(
                           [nan if row["standard_error"] is None else row["standard_error"] for row in rows]),
                       "lower": _numpy.array([nan if low is None else low for low, _ in interval]),
                       "upper": _numpy.array([nan if high is None else high for _, high in interval]),
                       "unit": [row["unit"] for row in rows], "verdict": [row["verdict"] for row in rows]}, "name")

    def __getitem__(self, name):
        """The value of a parameter."""
        for row in self.json["parameters"]:
            if row["name"] == name:
                return row["value"]
        raise KeyError(f"{name} is not a parameter of this fit: {', '.join(r['name'] for r in self.json['parameters'])}")

    @property
    def covariance(self):
        """Of the estimates, (n, n) in the order of `parameters` and their units; NaN where one is not determined."""
        return self._core.covariance()

    @property
    def effects(self):
        """Effects that were tried and what was decided, of close_loop()."""
        return self.json.get("effects", [])

    @property
    def residuals(self):
        """Measured, simulated and residual of every signal by recording and time; with a missing force, that too."""
        return _csv(self._core.residuals_csv())

    @property
    def prediction(self):
        """Measured, predicted and half widths of the 95 % bands of what was not fitted, of predict()."""
        return _csv(self._core.prediction_csv())

    @property
    def axis(self):
        """The fitted axis, with what is not known of it."""
        axis = Axis.from_yaml(dict(self._core.files(""))["fitted.yaml"])
        axis.name = "fitted.yaml"
        return axis

    def to_json(self):
        """result.json, as fit-params writes it."""
        return self._core.json

    def report(self):
        """The report of the command, as text."""
        return self._core.text()

    def save(self, folder):
        """Writes the files of `fit-params --output`: whole or not at all."""
        self._core.save(_os.fspath(folder), "")

    def __repr__(self):
        return self.report()

    def _repr_html_(self):
        parameters = self.parameters
        table = parameters.to_html() if hasattr(parameters, "to_html") else ""
        escaped = self.verdict.replace("&", "&amp;").replace("<", "&lt;")
        return f"<p><b>{escaped}</b></p>{table}"


def _progress(wanted):
    """A function to be told of progress, or None."""
    if callable(wanted) or wanted is None and not _sys.stderr.isatty() and "ipykernel" not in _sys.modules:
        return wanted
    if wanted is False:
        return None

    def show(phase, done, of, best):
        part = f" {done} of {of}" if of else ""
        text = f"{phase}{part}" + (f", chi2 {best:.4g}" if best == best else "")
        _sys.stderr.write(f"\r{text:<78.78}")
        _sys.stderr.flush()
    return show


def fit(job, *, close_loop=False, profile=(), suggest_experiment=False, predict=False, within=(), compare=False,
        threads=None, starts=None, seed=None, time_limit=None, progress=None):
    """Fits a job, as `fit-params` does with the options of the same names.

    job: a Job, or the path of a job file. profile: names of parameters, or "all". predict: True, or the path of a
    motion file; within: errors for which to judge the bands, such as "1 mm". compare: True, or paths of axis files whose
    models are compared, too. time_limit: s, after which what is finished is returned; TimeoutError where that is
    nothing. progress: True, False, or a function of (phase, done, of, chi_square); by default it is shown where someone
    looks.
    Ctrl-C raises KeyboardInterrupt, whose attribute `result` is what was finished.
    """
    if not isinstance(job, Job):
        job = Job.from_file(job)
    names = [profile] if isinstance(profile, str) else list(profile)
    motion = _os.fspath(predict) if not isinstance(predict, bool) else ""
    try:
        core = _core.fit(job._core, close_loop, names, suggest_experiment, bool(predict), motion,
                         [within] if isinstance(within, str) else list(within), bool(compare),
                         [_os.fspath(path) for path in compare] if not isinstance(compare, bool) else [], threads,
                         starts, seed, time_limit, _progress(progress))
    except KeyboardInterrupt as stopped:
        partial = getattr(stopped, "result", None)
        stopped.result = Result(partial) if partial is not None else None
        raise
    finally:
        if _progress(progress) is not None and not callable(progress):
            _sys.stderr.write("\r" + " " * 78 + "\r")
    return Result(core)


def close_loop(job, **options):
    """fit() and the search for the effects that the model lacks, each judged on what was not fitted."""
    return fit(job, close_loop=True, **options)


def profile(job, *names, **options):
    """fit() and likelihood profiles of parameters, of all without names: result.json["profile"]."""
    return fit(job, profile=names or ("all",), **options)


def suggest_experiment(job, **options):
    """fit() and the motion to record next: result.json["next_experiment"]."""
    return fit(job, suggest_experiment=True, **options)


def predict(job, motion=None, **options):
    """fit() and the recordings to validate, and a motion file's motion, with 95 % bands: result.prediction."""
    return fit(job, predict=True if motion is None else motion, **options)


def simulate(axis, motion, *, signals=("position", "velocity"), rate=1000.0, seed=1, exact=False, band=False):
    """What instruments would record of a motion: a DataFrame of time_s, the command and the signals.

    axis: a path, a dict or an Axis. motion: the path of a motion file, or a dict of one. signals: names. rate: samples
    per second. exact: without noise and quantisation. band: with half widths of 95 % bands, of a fitted axis.
    """
    axis = Axis(axis)
    if isinstance(motion, dict):
        import tempfile
        with tempfile.TemporaryDirectory() as folder:
            path = _os.path.join(folder, "motion.yaml")
            with open(path, "w", encoding="utf-8") as file:
                _json.dump(motion, file)
            return _frame(_core.simulate(axis.text, axis.name, path, list(signals), rate, seed, exact, band))
    return _frame(_core.simulate(axis.text, axis.name, _os.fspath(motion), list(signals), rate, seed, exact, band))


def init(recordings, folder=".", *, axis=None, machine=None, gain=None, columns=(), rate="", motor="", progress=None):
    """A first job for recordings that nobody has described: writes job.yaml and axis.yaml into the folder.

    recordings: paths. The keywords are the options of `fit-params --init`. Returns the Job; its attribute `guesses` has
    what to check.
    """
    recordings = [recordings] if isinstance(recordings, (str, _os.PathLike)) else recordings
    folder = _os.fspath(folder)
    files, guesses = _core.init([_os.fspath(r) for r in recordings], folder, _os.fspath(axis or ""), machine or "", gain,
                                list(columns), rate, str(motor), _progress(progress))
    for name, _ in files:
        if _os.path.exists(_os.path.join(folder, name)):
            raise FileExistsError(f"{_os.path.join(folder, name)} already exists and would be overwritten")
    _os.makedirs(folder, exist_ok=True)
    for name, text in files:
        with open(_os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(text)
    job = Job.from_file(_os.path.join(folder, files[-1][0]))
    job.guesses = guesses
    return job
