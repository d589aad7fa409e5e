"""The package's types: the stub names what the compiled part has, and mypy finds nothing in the package (skipped where it is not
installed)."""
import ast
import importlib.util
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import peerd
from peerd import _peerd

PACKAGE = Path(peerd.__file__).parent


class TypesTest(unittest.TestCase):
    def test_the_stub_has_the_names_of_the_compiled_part(self):
        stub = ast.parse((PACKAGE / "_peerd.pyi").read_text())
        classes = {node.name: node for node in stub.body if isinstance(node, ast.ClassDef)}
        public = lambda names: {name for name in names if not name.startswith("_")}
        of_pybind = {"EventKind": {"name", "value"}}  # each enumeration has them
        for name, node in classes.items():
            said = {each.name for each in node.body if isinstance(each, ast.FunctionDef)}
            said |= {each.target.id for each in node.body if isinstance(each, ast.AnnAssign)}
            there = set(vars(getattr(_peerd, name))) | of_pybind.get(name, set())
            self.assertEqual(public(said), public(there), name)
        functions = {node.name for node in stub.body if isinstance(node, ast.FunctionDef)}
        values = {node.target.id for node in stub.body if isinstance(node, ast.AnnAssign)}
        self.assertEqual(public(functions | values | set(classes)), public(vars(_peerd)))

    def test_all_that_people_use_says_what_it_is(self):
        self.assertTrue((PACKAGE / "py.typed").exists())
        for name, value in vars(peerd.Peer).items():
            if not name.startswith("_"):
                self.assertTrue(value.__doc__, f"Peer.{name} has no docstring")

    @unittest.skipUnless(importlib.util.find_spec("mypy"), "there is no mypy: install mypy")
    def test_mypy_finds_nothing(self):
        with tempfile.TemporaryDirectory() as cache:
            done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", cache, "-p", "peerd"], cwd=PACKAGE.parent,
                                  text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.assertEqual(done.returncode, 0, done.stdout)


if __name__ == "__main__":
    unittest.main()
