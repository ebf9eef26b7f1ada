# SPDX-License-Identifier: Apache-2.0
"""Every public function, method and class of the package says what it does; where arrays go in or come
out, it has the shape of each in brackets and its unit, or says by type or word that it has none. What goes
in and comes out has type hints."""
import ast
import importlib
import inspect
import pathlib
import re
import textwrap
import unittest

import sunder

SHAPE = re.compile(r"\((?:\w+, *)*(?:\w+,|\d+)\)|shape \(\)")  # (n, 3), (3,), (tets,)
UNIT = re.compile(r"\[[^\]]*\b(?:mm|N|MPa|s|ms|deg)\b[^\]]*\]")
NO_UNIT = re.compile(r"\b(?:bool|int32|ids|records|no unit)\b")


def body_of(function):
    return ast.parse(textwrap.dedent(inspect.getsource(function)))


def calls(tree):
    """Names of the functions that a body calls, each with its arguments."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, (ast.Attribute, ast.Name)):
            yield getattr(node.func, "attr", None) or node.func.id, node.args


def arrays_in(function, cls=None, seen=()):
    """How many arrays a function checks on their way in, itself or by private methods of its class."""
    count = 0
    for name, arguments in calls(body_of(function)):
        if name in ("reals", "ids") and len(arguments) == 3:
            count += not (isinstance(arguments[2], ast.Tuple) and not arguments[2].elts)
        elif name == "_three":
            count += 1
        helper = vars(cls).get(name) if cls and name.startswith("_") and name not in seen else None
        if inspect.isfunction(helper):
            count += arrays_in(helper, cls, (*seen, name))
    return count


def modules():
    for path in sorted(pathlib.Path(sunder.__file__).parent.glob("[a-z]*.py")):
        yield importlib.import_module("sunder." + path.stem)


def public_things():
    """Functions and classes by their full names."""
    found = {f"{m.__name__}.{n}": thing for m in modules() for n, thing in vars(m).items()
             if not n.startswith("_") and getattr(thing, "__module__", "") == m.__name__}
    for name in sunder.__all__:
        for thing in getattr(getattr(sunder, name), "__mro__", [getattr(sunder, name)]):
            module, own = getattr(thing, "__module__", ""), getattr(thing, "__name__", "_")
            if module.startswith("sunder.") and module != "sunder._c" and not own.startswith("_"):
                found[f"{module}.{own}"] = thing
    return found


def public():
    """(name, docstring, arrays that go in, arrays that come out)."""
    for where, thing in public_things().items():
        if inspect.isclass(thing):
            yield from members(where, thing)
        elif inspect.isfunction(thing):
            yield where, thing.__doc__, arrays_in(thing), arrays_out(thing)


def arrays_out(function):
    alternatives = str(inspect.signature(function).return_annotation).split(" | ")
    return max(text.count("ndarray") for text in alternatives)


def functions_of(cls):
    functions = {n: getattr(f, "__func__", getattr(f, "fget", None)) or f for n, f in vars(cls).items()}
    return {n: f for n, f in functions.items()
            if inspect.isfunction(f) and "sunder" in f.__code__.co_filename}  # a dataclass has others


def members(where, cls):
    functions = functions_of(cls)
    called = {name for f in functions.values() for name, _ in calls(body_of(f))}
    # What a class is made of stands in its own text; so does what is called by a name that is put together.
    own = [f for n, f in functions.items() if n.startswith("_") and n not in called]
    yield where, cls.__doc__, sum(arrays_in(f, cls) for f in own), 0
    for name, function in functions.items():
        if not name.startswith("_"):
            yield f"{where}.{name}", function.__doc__, arrays_in(function, cls), arrays_out(function)


class Docstrings(unittest.TestCase):
    def test_every_public_thing_has_one_with_shapes_and_units(self):
        with_arrays = 0
        for name, text, going_in, coming_out in public():
            with self.subTest(name):
                self.assertTrue(text and text.strip(), "has no docstring")
                count = going_in + coming_out
                with_arrays += count > 0
                shapes, units = len(SHAPE.findall(text)), len(UNIT.findall(text)) + len(NO_UNIT.findall(text))
                self.assertGreaterEqual(shapes, count, f"{count} arrays, shapes named: {shapes}\n{text}")
                self.assertGreaterEqual(units, count, f"{count} arrays, units named: {units}\n{text}")
        self.assertGreater(with_arrays, 35)

    def test_every_public_function_has_type_hints(self):
        count = 0
        for where, thing in public_things().items():
            functions = functions_of(thing) if inspect.isclass(thing) else {"": thing}
            for name, function in functions.items():
                if not inspect.isfunction(function) or name.startswith("_") and name != "__init__":
                    continue
                count += 1
                signature = inspect.signature(function)
                bare = [p.name for p in signature.parameters.values()
                        if p.annotation is p.empty and p.name not in ("self", "cls")]
                self.assertEqual(bare, [], f"{where}.{name}")
                if name != "__init__":
                    self.assertIsNot(signature.return_annotation, signature.empty, f"{where}.{name}")
        self.assertGreater(count, 100)

    def test_the_search_sees_what_goes_in_and_comes_out(self):
        found = {name: (a, b) for name, _, a, b in public()}
        self.assertEqual(found["sunder.simulation.Simulation.displacement"], (0, 1))
        self.assertEqual(found["sunder._live.Live.push"], (2, 0))
        self.assertEqual(found["sunder._threads.Grips.forces"], (1, 1))
        self.assertEqual(found["sunder.scene.Selection"], (4, 0))
        self.assertGreaterEqual(found["sunder.scene.Scene.add_instrument"][0], 4)
        self.assertTrue({"Scene", "Simulation", "Mesh"} <= {pathlib.Path(n).suffix[1:] for n in found})


if __name__ == "__main__":
    unittest.main()
