#!/usr/bin/python3
"""axisfit_test.py MODULES PROGRAMS PROJECT: the module for Python, against the programs."""
import io
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

MODULES, PROGRAMS, PROJECT = (pathlib.Path(path).resolve() for path in sys.argv[1:4])
sys.path.insert(0, str(MODULES))

try:
    import numpy
except ImportError:
    print("skipped: python3-numpy is not installed")
    sys.exit(77)
try:
    import pandas
except ImportError:
    pandas = None
import axisfit

PAPER = PROJECT / "configs" / "jobs" / "paper.yaml"
AXIS = PROJECT / "configs" / "axes" / "x.yaml"
FREE = {"V_L": {"initial": "8 V"}, "B_a": {"initial": "60 N s/m"}, "b_g": {"initial": "5000 N s/m"},
        "k_g": {"initial": "1.5e6 N/m"}, "T_p": {"initial": "0.1 s"}}
UNITS = {"time_s": "s", "set_velocity_v": "V", "velocity_mps": "m/s", "acceleration_mps2": "m/s^2"}


def printed(*arguments):
    return subprocess.run([PROGRAMS / arguments[0], *arguments[1:]], check=False, capture_output=True, text=True).stdout


def without_time(text):
    """A result without what differs from run to run and by who made it."""
    result = json.loads(text)
    del result["wall_time_s"], result["work"]
    return result


def columns(name="clean-fit.csv"):
    text = (PROJECT / "testdata" / name).read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    values = numpy.loadtxt(io.StringIO("\n".join(lines[1:])), delimiter=",")
    return {head: numpy.ascontiguousarray(values[:, i]) for i, head in enumerate(lines[0].split(","))}


def recording(data, **keys):
    return axisfit.Recording(data, time="time_s", units=UNITS, name="step", signals={
        "command": "set_velocity_v",
        "velocity": {"column": "velocity_mps", "unit": "m/s", "sigma": "2 mm/s"},
        "acceleration": {"column": "acceleration_mps2", "unit": "m/s^2", "sigma": "0.05 m/s^2"}}, **keys)


class Fit(unittest.TestCase):
    def test_has_the_digits_of_the_command(self):
        result = axisfit.fit(PAPER)
        self.assertEqual(without_time(result.to_json()), without_time(printed("fit-params", PAPER, "--json")))
        self.assertTrue(result.usable)
        self.assertEqual(result.grade, "explained")

    def test_is_the_same_from_arrays_as_from_files(self):
        from_file = axisfit.fit(PAPER)
        job = axisfit.Job(axis=AXIS, recordings=[recording(columns())], free=FREE)
        self.assertEqual(job.free, ["V_L", "B_a", "b_g", "k_g", "T_p"])
        from_arrays = axisfit.fit(job)
        self.assertEqual(from_arrays.json["parameters"], from_file.json["parameters"])
        if pandas:
            frame = axisfit.fit(axisfit.Job(AXIS, [recording(pandas.DataFrame(columns()))], FREE))
            self.assertEqual(frame.json["parameters"], from_file.json["parameters"])
        by_path = axisfit.Job(AXIS, [recording(PROJECT / "testdata" / "clean-fit.csv")], FREE)
        self.assertEqual(axisfit.fit(by_path).json["parameters"], from_file.json["parameters"])
        text = PAPER.read_text(encoding="utf-8")
        from_yaml = axisfit.Job.from_yaml(text, PAPER.parent)
        self.assertEqual(axisfit.fit(from_yaml).json["parameters"], from_file.json["parameters"])

    def test_takes_an_axis_as_a_dict(self):
        axis = {"drive": "force_source", "transmission": "rigid", "parameters": {"K_f": "40 N/V", "M": "15 kg",
                                                                                 "B_a": "20 N s/m"}}
        step = axisfit.simulate({**axis, "parameters": {"K_f": "40 N/V", "M": "20 kg", "B_a": "30 N s/m"}},
                                {"type": "step", "level": "5 V", "duration": "1 s"}, signals=["velocity"])
        time_s, command, velocity = (numpy.asarray(step[name]) for name in list(step))
        data = {"t": time_s, "u": command, "v": velocity + 1e-4 * numpy.sin(7.0 * numpy.arange(len(time_s)) ** 2)}
        job = axisfit.Job(axis, [axisfit.Recording(data, time="t", units={"t": "s", "u": "V", "v": "m/s"},
                                                   signals={"command": "u", "velocity": "v"})], ["M", "B_a"])
        result = axisfit.fit(job)
        self.assertAlmostEqual(result["M"], 20.0, delta=0.02)
        self.assertAlmostEqual(result["B_a"], 30.0, delta=0.05)
        with self.assertRaisesRegex(KeyError, "no_such is not a parameter of this fit: M, B_a"):
            result["no_such"]

    def test_has_tables_and_arrays(self):
        result = axisfit.fit(PAPER)
        covariance = result.covariance
        self.assertEqual(covariance.shape, (5, 5))
        table = result.parameters
        errors = numpy.asarray(table["standard_error"])
        numpy.testing.assert_allclose(numpy.sqrt(numpy.diag(covariance)), errors, rtol=1e-12)
        numpy.testing.assert_allclose(covariance / numpy.outer(errors, errors),
                                      numpy.array(result.json["correlation"], dtype=float), atol=1e-12)
        residuals = result.residuals
        numpy.testing.assert_allclose(
            numpy.asarray(residuals["velocity_measured"]) - numpy.asarray(residuals["velocity_simulated"]),
            numpy.asarray(residuals["velocity_residual"]), atol=1e-6)
        self.assertIn("V_L", result.report())
        self.assertIn("<p><b>", result._repr_html_())
        if pandas:
            self.assertEqual(list(table.index), ["V_L", "B_a", "b_g", "k_g", "T_p"])

    def test_saves_the_files_of_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            result = axisfit.fit(PAPER)
            result.save(os.path.join(folder, "module"))
            printed("fit-params", PAPER, "--output", os.path.join(folder, "program"))
            names = sorted(os.listdir(os.path.join(folder, "program")))
            self.assertEqual(sorted(os.listdir(os.path.join(folder, "module"))), names)
            for name in ("fitted.yaml", "residuals.csv"):
                texts = [pathlib.Path(folder, made, name).read_text(encoding="utf-8") for made in ("module", "program")]
                self.assertEqual(*texts)
            again = axisfit.simulate(os.path.join(folder, "module", "fitted.yaml"),
                                     {"type": "step", "level": "5 V", "duration": "0.1 s"}, band=True, exact=True,
                                     signals=["velocity"])
            self.assertIn("velocity_mps_half_width", list(again))
            self.assertEqual(result.axis.text.splitlines()[2:], pathlib.Path(
                folder, "module", "fitted.yaml").read_text(encoding="utf-8").splitlines()[2:])

    def test_does_what_was_asked_for(self):
        result = axisfit.profile(PAPER, "V_L")
        self.assertEqual([p["name"] for p in result.json["profile"]], ["V_L"])
        self.assertEqual(axisfit.fit(PAPER, starts=3, seed=5, threads=1).json["seed"], 5)
        with tempfile.TemporaryDirectory() as folder:
            axisfit.fit(PAPER).save(folder)
            compared = axisfit.fit(PROJECT / "configs" / "jobs" / "close-loop.yaml", within="1 mm/s", predict=True,
                                   compare=[os.path.join(folder, "fitted.yaml")])
        self.assertEqual(len(compared.json["comparison"]["models"]), 2)
        self.assertIn("below 1 mm/s", compared.report())
        self.assertIn("velocity_half_width", list(compared.prediction))
        told = []
        axisfit.fit(PAPER, starts=2, progress=lambda *what: told.append(what))
        self.assertTrue(all(len(what) == 4 for what in told))


class Pictures(unittest.TestCase):
    def test_are_drawn(self):
        try:
            import matplotlib
        except ImportError:
            self.skipTest("python3-matplotlib is not installed")
        matplotlib.use("Agg")
        plot = axisfit.fit(PAPER).plot
        for draw in (plot.signals, plot.residual, plot.friction_map, plot.force_over_position, plot.parameters):
            axes = draw()
            self.assertTrue(axes.lines or axes.collections)
        self.assertEqual(plot.friction_map().get_xlabel(), "arm_velocity_mps")


class Mistakes(unittest.TestCase):
    def test_have_their_places(self):
        with self.assertRaises(axisfit.JobError) as raised:
            axisfit.Job.from_yaml(PAPER.read_text(encoding="utf-8").replace("V_L:", "V_Q:"), PAPER.parent)
        file, line, column, message = raised.exception.diagnostics[0]
        self.assertTrue(file.endswith("job.yaml"))
        self.assertEqual((line, column), (14, 3))
        self.assertIn("V_Q", message)
        self.assertIn(f":{line}:{column}: {message}", str(raised.exception))
        self.assertIsInstance(raised.exception, ValueError)

    def test_of_columns_are_said_at_once(self):
        with self.assertRaisesRegex(ValueError, "column 'v' has no unit: add it to units, as in units={'v': 's'}"):
            axisfit.Recording({"v": [1.0]}, time="v", signals={})
        with self.assertRaisesRegex(TypeError, "column 'name' holds <U1, not numbers"):
            axisfit.Recording({"name": ["a"]}, time="name", signals={}, units={"name": "s"})
        with self.assertRaisesRegex(ValueError, "'two' must have one dimension, not 2"):
            axisfit.Job(AXIS, [recording({**columns(), "two": numpy.zeros((2, 2))})], FREE)
        with self.assertRaisesRegex(axisfit.JobError, "velocity_mps"):
            axisfit.Job(AXIS, [recording({"time_s": numpy.arange(30.0), "set_velocity_v": numpy.zeros(30)})], FREE)
        with self.assertRaises(RuntimeError):
            axisfit.fit(PAPER, profile="no_such")

    def test_of_options_are_said_before_the_fit(self):
        with self.assertRaisesRegex(ValueError, "^starts must be at least 1, not 0$"):
            axisfit.fit(PAPER, starts=0)
        with self.assertRaisesRegex(ValueError, "^threads must be at least 0, not -1$"):
            axisfit.fit(PAPER, threads=-1)

    def test_of_files_are_said(self):
        with self.assertRaisesRegex(ValueError, "no-such.yaml"):
            axisfit.Job.from_file("no-such.yaml")


class Simulate(unittest.TestCase):
    def test_has_the_digits_of_the_command(self):
        motion = PROJECT / "configs" / "motions" / "step.yaml"
        found = axisfit.simulate(AXIS, motion, signals=["velocity"], exact=True)
        text = printed("simulate-axis", AXIS, motion, "--signals", "velocity", "--exact")
        values = numpy.loadtxt(io.StringIO(text), delimiter=",", skiprows=1)
        numpy.testing.assert_array_equal(numpy.column_stack([numpy.asarray(found[c]) for c in list(found)]), values)
        with self.assertRaisesRegex(ValueError, "no signal 'speed'"):
            axisfit.simulate(AXIS, motion, signals=["speed"])


class Init(unittest.TestCase):
    def test_writes_a_job_and_reads_it(self):
        with tempfile.TemporaryDirectory() as folder:
            job = axisfit.init(PROJECT / "testdata" / "clean-fit.csv", folder)
            self.assertTrue(os.path.exists(os.path.join(folder, "job.yaml")))
            self.assertTrue(job.free)
            self.assertIsInstance(job.guesses, list)
            with self.assertRaises(FileExistsError):
                axisfit.init(PROJECT / "testdata" / "clean-fit.csv", folder)

    def test_takes_the_answers_of_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            two = PROJECT / "testdata" / "contact" / "two-motors.csv"
            job = axisfit.init(two, folder, motor=1, gain=1.0)
            self.assertEqual(list(job.free)[0], "M")
            with self.assertRaisesRegex(RuntimeError, "--rate apples: write how many samples"):
                axisfit.init(two, os.path.join(folder, "other"), rate="apples")


class Interrupted(unittest.TestCase):
    def test_ends_soon_with_what_is_finished(self):
        sent = []

        def interrupt(phase, done, of, best):
            if done >= 2 and not sent:
                sent.append(time.monotonic())
                signal.raise_signal(signal.SIGINT)
        with self.assertRaises(KeyboardInterrupt) as raised:
            axisfit.fit(PAPER, starts=100000, progress=interrupt)
        took = time.monotonic() - sent[0]
        print(f"stopped after {took:.3f} s", file=sys.stderr)
        self.assertTrue(raised.exception.result.interrupted)
        self.assertGreaterEqual(len(raised.exception.result.json["starts"]), 2)

    def test_ends_at_the_time_limit(self):
        result = axisfit.fit(PAPER, starts=100000, time_limit=1.0)
        self.assertTrue(result.interrupted and result.json["time_limit_reached"])
        with self.assertRaises(TimeoutError):
            axisfit.fit(PAPER, starts=100000, time_limit=1e-9, threads=1)

    def test_leaves_other_threads_running(self):
        counted = []
        stop = threading.Event()

        def count():
            while not stop.wait(0.001):
                counted.append(1)
        thread = threading.Thread(target=count)
        thread.start()
        axisfit.fit(PAPER, starts=4)
        stop.set()
        thread.join()
        self.assertGreater(len(counted), 5)


class Stubs(unittest.TestCase):
    def test_say_what_there_is(self):
        found = subprocess.run(["/usr/bin/python3", "-m", "mypy.stubtest", "axisfit", "--allowlist", "/dev/stdin"],
                               input="axisfit._core.(Job|Result)(.__init__)?\n",  # pybind11's
                               capture_output=True, text=True, check=False,
                               env={**os.environ, "PYTHONPATH": str(MODULES), "MYPYPATH": str(MODULES)})
        if "No module named mypy" in found.stderr:
            self.skipTest("mypy is not installed")
        self.assertEqual(found.returncode, 0, found.stdout + found.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
