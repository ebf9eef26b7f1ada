# SPDX-License-Identifier: Apache-2.0
"""The Python package as a page: its public names with signatures and docstrings, read from the
source, so that nothing has to be built."""
import ast
import pathlib


def _signature(function, of_class):
    arguments = ast.unparse(function.args)
    if of_class and arguments.split(",")[0].strip() in ("self", "cls"):
        arguments = arguments.partition(",")[2].strip()
    returns = f" -> {ast.unparse(function.returns)}" if function.returns else ""
    return f"{function.name}({arguments}){returns}"


def _text(docstring):
    """A docstring's paragraphs; indented lists of arguments as code."""
    return ["```text", docstring, "```", ""] if "\n" in docstring else [docstring, ""]


def _function(node, of_class=""):
    title = f"{of_class}.{node.name}" if of_class else node.name
    out = [f"### `{title}`", "", "```python", _signature(node, bool(of_class)), "```", ""]
    docstring = ast.get_docstring(node)
    return out + (_text(docstring) if docstring else [])


def _public(node):
    return not node.name.startswith("_")


def _lacks(node):
    """What a public class or function has to have and this one has not."""
    lacking = [] if ast.get_docstring(node) else ["a docstring"]
    if isinstance(node, ast.FunctionDef):
        given = node.args.posonlyargs + node.args.args + node.args.kwonlyargs
        hinted = all(a.annotation for a in given if a.arg not in ("self", "cls")) and node.returns
        lacking += [] if hinted else ["type hints"]
    return " and ".join(lacking)


def page(package: pathlib.Path) -> str:
    """Markdown of a package's folder: every public class and function.
    Raises ValueError for a public one without a docstring or type hints."""
    out = ["# Python package", "", ast.get_docstring(ast.parse((package / "__init__.py").read_text())), ""]
    bare = []
    for path in sorted(package.glob("*.py"), key=lambda p: (p.name.startswith("_") and p.name != "__init__.py", p.name)):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        # Of modules that are the package's own, the parts of its classes alone.
        own = path.name.startswith("_") and path.name != "__init__.py"
        found = [n for n in tree.body if isinstance(n, (ast.ClassDef, ast.FunctionDef)) and _public(n)]
        if own:
            found = [n for n in found if isinstance(n, ast.ClassDef) and n.name == "Live"]
        if not found:
            continue
        title = "A live body" if own else path.stem.capitalize()
        if path.name == "__init__.py":
            out += ["## Run", ""]
        else:
            out += [f"## {title}", "", ast.get_docstring(tree) or "", ""]
        for node in found:
            bare += [f"{path.name}: {node.name} lacks {_lacks(node)}"] if _lacks(node) else []
            if isinstance(node, ast.FunctionDef):
                out += _function(node)
                continue
            name = "Simulation" if node.name == "Live" else node.name
            if node.name != "Live":
                start = next((n for n in node.body if isinstance(n, ast.FunctionDef)
                              and n.name == "__init__"), None)
                of = _signature(start, True).removeprefix("__init__") if start else ""
                out += [f"### `{name}`", "", "```python", f"class {name}{of}", "```", "",
                        *_text(ast.get_docstring(node) or "")]
            for part in node.body:
                if isinstance(part, ast.FunctionDef) and _public(part):
                    bare += [f"{path.name}: {name}.{part.name} lacks {_lacks(part)}"] if _lacks(part) else []
                    out += _function(part, name)
    if bare:
        raise ValueError("; ".join(bare))
    return "\n".join(out) + "\n"
