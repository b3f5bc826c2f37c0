#!/usr/bin/env python3
"""The stubs contain the module's names, and no others; faulty examples show that the check detects errors."""
import ast
import inspect
import unittest

from built import TREE
import palpate
from palpate import _palpate

STUBS = TREE / "src/python/palpate/_palpate.pyi"


def is_public(name):
    return not name.startswith("_") or name in ("__init__", "__len__")


def names_of_stubs(text):
    """Names in the stubs: "Scene", "Scene.set", "Scene.set(path, value)" for functions with their
    arguments."""
    def signature(function):
        names = [one.arg for one in (*function.args.args, *function.args.kwonlyargs)]
        return f"({', '.join(name for name in names if name != 'self')})"

    def is_property(function):
        return any(isinstance(one, ast.Name) and one.id == "property" for one in function.decorator_list)
    out = set()
    for node in ast.parse(text).body:
        if isinstance(node, ast.FunctionDef) and is_public(node.name):
            out.add(node.name + signature(node))
        if isinstance(node, ast.ClassDef) and is_public(node.name):
            out.add(node.name)
            out |= {f"{node.name}.{one.name}" + ("" if is_property(one) else signature(one))
                    for one in node.body if isinstance(one, ast.FunctionDef) and is_public(one.name)}
    return out


def names_of_module(module):
    """Names in the module; pybind11 writes a function's signature in the first line of its docstring."""
    def signature(function):
        line = (function.__doc__ or "").splitlines()[0]
        arguments = line[line.index("(") + 1:line.rindex(")")]
        depth, names, current = 0, [], ""
        for letter in arguments + ",":
            depth += (letter in "[(") - (letter in "])")
            if letter == "," and depth == 0:
                names.append(current.split(":")[0].strip())
                current = ""
            else:
                current += letter
        return f"({', '.join(name for name in names if name not in ('self', 'arg0', ''))})"
    out = set()
    for name, item in vars(module).items():
        if not is_public(name):
            continue
        if not inspect.isclass(item):
            out.add(name + signature(item))
            continue
        out.add(name)
        for member, value in vars(item).items():
            if not is_public(member) or issubclass(item, Exception):
                continue
            if member == "__init__" and "No constructor" not in repr(value) and not (
                    value.__doc__ or "").startswith("__init__("):
                continue
            out.add(f"{name}.{member}" + ("" if isinstance(value, property) else signature(
                value.__func__ if isinstance(value, staticmethod) else value)))
    return out


class Stubs(unittest.TestCase):
    def test_they_name_what_is_there(self):
        stubs, module = names_of_stubs(STUBS.read_text()), names_of_module(_palpate)
        self.assertGreater(len(module), 70)
        self.assertEqual(stubs - module, set(), "in the stubs alone")
        self.assertEqual(module - stubs, set(), "in the module alone")

    def test_a_difference_is_found(self):
        text = STUBS.read_text()
        module = names_of_module(_palpate)
        for old, new in (("def step(self)", "def stp(self)"), ("seconds: float)", "second: float)"),
                         ("def positions", "def position"), ("def validate(", "def validated(")):
            with self.subTest(new=new):
                self.assertIn(old, text)
                self.assertNotEqual(names_of_stubs(text.replace(old, new)), module)

    def test_everything_public_is_exported_and_described(self):
        self.assertEqual(sorted(palpate.__all__), palpate.__all__)
        stubs = {name for name in names_of_stubs(STUBS.read_text()) if "." not in name}
        exported = {name for name in palpate.__all__
                    if getattr(palpate, name).__module__ == "palpate._palpate"}
        self.assertEqual({name.split("(")[0] for name in stubs} - {"compare_into"},
                         exported | {"load", "validate"})
        for name in palpate.__all__:
            self.assertTrue(getattr(palpate, name).__doc__, name)


if __name__ == "__main__":
    unittest.main(argv=[__file__])
