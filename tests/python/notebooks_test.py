#!/usr/bin/python3
"""notebooks_test.py MODULES PROJECT: the notebooks of examples/, from top to bottom."""
import os
import pathlib
import sys
import unittest

MODULES, PROJECT = (pathlib.Path(path).resolve() for path in sys.argv[1:3])

try:
    import nbclient
    import nbformat
except ImportError:
    print("skipped: python3-nbclient is not installed")
    sys.exit(77)


class Notebooks(unittest.TestCase):
    def test_run_from_top_to_bottom(self):
        notebooks = sorted((PROJECT / "examples" / "notebooks").glob("*.ipynb"))
        self.assertGreaterEqual(len(notebooks), 3)
        os.environ["PYTHONPATH"] = str(MODULES)
        for path in notebooks:
            with self.subTest(path.name):
                notebook = nbformat.read(path, as_version=4)
                self.assertTrue(all(not cell.get("outputs") for cell in notebook.cells), "commit it without output")
                nbclient.NotebookClient(notebook, timeout=600, kernel_name="python3",
                                        resources={"metadata": {"path": str(path.parent)}}).execute()


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
