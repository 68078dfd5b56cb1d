#!/usr/bin/env python3
"""same_result_test.py BIN: whether same_result.py notices what has changed, and only that, in a
result that programs of the test write anew."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

BIN = pathlib.Path(sys.argv.pop(1)).resolve()
HERE = pathlib.Path(__file__).resolve().parent
JOB = "screw-viscous"


class SameResult(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        job = HERE.parents[1] / f"configs/jobs/{JOB}.yaml"
        cls.result = subprocess.run([BIN / "fit-params", job, "--close-loop", "--json"],
                                    check=True, capture_output=True, text=True).stdout  # fmt: skip

    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.write("one", self.result)
        self.write("other", self.result)

    def write(self, name, result, code=0):
        """A program that prints this result."""
        (self.folder / name).mkdir(exist_ok=True)
        (self.folder / name / "result").write_text(result)
        program = self.folder / name / "fit-params"
        program.write_text(f'#!/bin/sh\ncat "${{0%/*}}/result"\nexit {code}\n')
        program.chmod(0o755)

    def compare(self, job=JOB):
        """The exit code, and all that is printed."""
        done = subprocess.run([sys.executable, HERE / "same_result.py", self.folder / "one",
                               self.folder / "other", job], text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT,
                              env=os.environ | {"AXISFIT_EMPS": str(self.folder)})  # fmt: skip
        return done.returncode, done.stdout

    def after(self, change):
        """What is printed once one of the results has been changed."""
        result = json.loads(self.result)
        change(result)
        self.write("one", json.dumps(result))
        return self.compare()

    def expect_same(self, change):
        self.assertEqual(
            self.after(change),
            (0, f"same     {JOB} --close-loop\n1 passed, 0 failed, 0 skipped\n"),
        )

    def expect_difference(self, path, change):
        code, text = self.after(change)
        self.assertEqual(code, 1, text)
        self.assertIn(f"differs  {JOB} --close-loop\n  {path}: ", text)
        self.assertIn("\n0 passed, 1 failed, 0 skipped\n", text)

    def test_nothing(self):
        self.expect_same(lambda result: None)

    def test_a_number(self):
        def scale(factor):
            def change(result):
                result["parameters"][0]["value"] *= factor

            return change

        self.expect_same(scale(1 + 5e-10))
        self.expect_difference("/parameters/0/value", scale(1 + 2e-9))

    def test_a_count(self):
        self.expect_difference("/iterations", lambda result: result.update(iterations=0))

    def test_names(self):
        self.expect_difference("/grade", lambda result: result.update(grade="usable"))
        self.expect_difference(
            "/parameters/0/verdict", lambda result: result["parameters"][0].update(verdict="weak")
        )
        self.expect_difference(
            "/models/0/added", lambda result: result["models"][0].update(added="dahl_friction")
        )

    def test_a_decision(self):
        def accepted(result):
            return next(e for e in result["effects"] if e["decision"] == "accepted")

        self.expect_difference(
            "/effects/0", lambda result: accepted(result).update(decision="rejected")
        )

    def test_a_key(self):
        self.expect_difference("/scatter", lambda result: result.pop("scatter"))
        self.expect_difference("/unheard", lambda result: result.update(unheard=None))

    def test_rejected_effects(self):
        self.expect_same(
            lambda result: result["effects"].append({"name": "lag", "decision": "rejected"})
        )

    def test_sentences(self):
        def change(result):
            result["verdict"] = result["selection"]["verdict"] = result["message"] = "Other words."
            result["recordings"][0]["warnings"] = ["One.", "And two."]
            for effect in result["effects"]:
                effect["reason"] = effect["meaning"] = "other words"

        self.expect_same(change)

    def test_programs_that_refuse_the_job(self):
        self.write("other", "", code=2)
        code, text = self.compare()
        self.assertEqual(code, 0, text)
        self.assertIn(f"skipped  {JOB} --close-loop: the other programs have no result", text)
        self.write("one", "", code=2)
        code, text = self.compare()
        self.assertEqual(code, 1, text)
        self.assertIn(f"differs  {JOB} --close-loop\n  no result: exit code 2", text)

    def test_missing_recordings(self):
        code, text = self.compare("emps")
        self.assertEqual(code, 0, text)
        self.assertIn(f"{self.folder}/DATA_EMPS.mat is missing\n", text)
        self.assertIn("0 passed, 0 failed, 1 skipped\n", text)


unittest.main()
