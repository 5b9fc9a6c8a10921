"""What the reference shows, and what docstrings say."""

from __future__ import annotations

import ast
import importlib
import inspect
import re
import textwrap
from dataclasses import fields, is_dataclass
from functools import cache

from griffe import Docstring, DocstringSectionKind
from pages import ROOT

REFERENCE = ROOT / "docs" / "reference"
DIRECTIVE = re.compile(r"^::: (?P<path>[\w.]+)\n(?P<options>(?:    .*\n)*)", re.M)


def resolve(path: str) -> object:
    """Object at a dotted path of modules and names."""
    module, _, name = path.rpartition(".")
    try:
        return importlib.import_module(path)
    except ModuleNotFoundError:
        return getattr(importlib.import_module(module), name)


@cache
def shown() -> dict[str, object]:
    """Every object on the pages, by the path under which it stands there."""
    found: dict[str, object] = {}
    for page in sorted(REFERENCE.glob("*.md")):
        for match in DIRECTIVE.finditer(page.read_text(encoding="utf-8") + "\n"):
            path = match["path"]
            value = resolve(path)
            if not inspect.ismodule(value):
                found[path] = value
                continue
            listed = re.search(r"members: \[(.*?)\]", match["options"])
            below = re.findall(r"^        - (\w+)$", match["options"], re.M)
            names = listed[1].split(", ") if listed else below or value.__all__
            found |= {f"{path}.{name}": getattr(value, name) for name in names}
    return found


def functions() -> dict[str, object]:
    """Functions on the pages, and public methods of the classes there.

    A method that a base class defines is documented there, once.
    """
    found = {path: value for path, value in shown().items() if inspect.isfunction(value)}
    for path, value in shown().items():
        if inspect.isclass(value):
            inherited = {name for base in value.__mro__[1:] for name in vars(base)}
            for name, member in vars(value).items():
                if name in inherited:
                    continue
                method = getattr(member, "__func__", member)
                if inspect.isfunction(method) and not name.startswith("_"):
                    found[f"{path}.{name}"] = method
    return found


def sections(value: object) -> dict[str, list[str]]:
    """Sections of a docstring with the names in them; empty for those without names."""
    text = inspect.getdoc(value) or ""
    found: dict[str, list[str]] = {}
    for part in Docstring(text).parse("numpy", warnings=False):
        if part.kind is DocstringSectionKind.raises:
            found["raises"] = [str(item.annotation) for item in part.value]
        elif part.kind in {DocstringSectionKind.parameters, DocstringSectionKind.attributes}:
            names = [name for item in part.value for name in re.split(r",\s*", item.name)]
            found[part.kind.value] = [name.lstrip("*") for name in names]
        else:
            found[part.kind.value] = []
    return found


def raised(function: object) -> set[str]:
    """Names of the errors that a function raises in its own lines."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    nodes = [node.exc for node in ast.walk(tree) if isinstance(node, ast.Raise) and node.exc]
    calls = [node.func for node in nodes if isinstance(node, ast.Call)]
    return {name.id for name in calls if isinstance(name, ast.Name)}


def arguments(function: object) -> list[str]:
    return [name for name in inspect.signature(function).parameters if name not in {"self", "cls"}]


def attributes(value: type) -> list[str]:
    names = [field.name for field in fields(value)] if is_dataclass(value) else []
    return [name for name in names if not name.startswith("_")]
