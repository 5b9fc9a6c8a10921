"""Docstrings that name every parameter, every attribute and every tuned number."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import radmpc

PACKAGE = Path(radmpc.__file__).parent
FILES = [
    file
    for file in sorted(PACKAGE.rglob("*.py"))
    # Options of commands document themselves in their help.
    if file.name
    not in {"cli.py", "flying_commands.py", "serving_commands.py"}  # what users read as help
]
FOLDERS = sorted({file.parent for file in FILES})
TUNED = [file for file in FILES if file.stem.endswith("tuning")]
NUMBER = re.compile(r"[-\d.e_+*/ ()]+")


def section(text: str, heading: str) -> set[str]:
    """Names that a numpydoc section explains, ``lower, upper : float`` two of them."""
    match = re.search(
        rf"^{heading}\n-+\n(.*?)(?=^\S[^\n]*\n-+$|\Z)", text, re.DOTALL | re.MULTILINE
    )
    lines = [] if match is None else [line for line in match[1].splitlines() if line[:1].strip()]
    return {name.strip(" *") for line in lines for name in line.split(" : ")[0].split(",")}


def parameters(function: ast.FunctionDef) -> set[str]:
    """Names of a function's parameters, its object or class left out."""
    given = function.args
    every = [*given.posonlyargs, *given.args, *given.kwonlyargs, given.vararg, given.kwarg]
    return {one.arg for one in every if one is not None} - {"self", "cls"}


def attributes(kind: ast.ClassDef) -> set[str]:
    """Names of a dataclass's public fields; what a whole class has is told where it is defined."""
    fields = [
        node.target
        for node in kind.body
        if isinstance(node, ast.AnnAssign)
        and not ast.unparse(node.annotation).startswith("ClassVar")
    ]
    return {f.id for f in fields if isinstance(f, ast.Name) and not f.id.startswith("_")}


def is_dataclass(kind: ast.ClassDef) -> bool:
    return any("dataclass" in ast.unparse(decorator) for decorator in kind.decorator_list)


def public_parts(tree: ast.Module) -> Iterator[ast.FunctionDef | ast.ClassDef]:
    """Public functions, classes and methods of public classes; overloads have no docstring."""
    for node in tree.body:
        if not isinstance(node, ast.FunctionDef | ast.ClassDef) or node.name.startswith("_"):
            continue
        if "overload" not in map(ast.unparse, node.decorator_list):
            yield node
            for method in node.body if isinstance(node, ast.ClassDef) else ():
                if isinstance(method, ast.FunctionDef) and not method.name.startswith("_"):
                    yield method


def gaps(source: str) -> list[str]:
    """Names that docstrings leave out or invent, by function or dataclass."""
    found = []
    for node in public_parts(ast.parse(source)):
        text = ast.get_docstring(node) or ""
        if isinstance(node, ast.FunctionDef):
            names, told = parameters(node), section(text, "Parameters")
            wrong = names ^ told if len(names) > 1 or told else set()
        else:
            names = attributes(node) if is_dataclass(node) else set()
            wrong = names - section(text, "Attributes")
        if wrong:
            found.append(f"{node.name}: {', '.join(sorted(wrong))}")
    return found


def unitless(source: str) -> list[str]:
    """Attributes of tuned numbers whose text names no unit in brackets."""
    found = []
    for node in ast.parse(source).body:
        if not isinstance(node, ast.ClassDef):
            continue
        _, _, told = (ast.get_docstring(node) or "").partition("Attributes\n----------\n")
        for entry in re.split(r"\n(?=\S)", told):
            names, _, text = entry.partition(" : ")
            # What holds records of numbers is one itself.
            if "Tuning\n" not in text and not re.search(r"\[[^\]]+\]", text):
                found.append(f"{node.name}: {names}")
    return found


def bare_constants(source: str) -> list[str]:
    """Module constants that are numbers and have no docstring below them."""
    body = ast.parse(source).body
    return [
        ast.unparse(node.targets[0])
        for node, below in zip(body, [*body[1:], None], strict=True)
        if isinstance(node, ast.Assign)
        and isinstance(node.targets[0], ast.Name | ast.Tuple)
        and NUMBER.fullmatch(ast.unparse(node.value))
        and not (isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant))
    ]


def found_in(folder: Path, look: Callable[[str], list[str]]) -> dict[str, list[str]]:
    """What is found in the files of a folder, by name."""
    files = [file for file in FILES if file.parent == folder]
    found = {file.name: look(file.read_text(encoding="utf-8")) for file in files}
    return {name: wrong for name, wrong in found.items() if wrong}


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: str(folder.relative_to(PACKAGE)))
def test_docstrings_explain_every_parameter_and_attribute(folder: Path) -> None:
    assert not found_in(folder, gaps)


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: str(folder.relative_to(PACKAGE)))
def test_numbers_say_what_they_do(folder: Path) -> None:
    assert not found_in(folder, bare_constants)


@pytest.mark.parametrize(
    "file", TUNED, ids=lambda file: str(file.relative_to(PACKAGE).with_suffix(""))
)
def test_every_tuned_number_has_a_unit(file: Path) -> None:
    assert not unitless(file.read_text(encoding="utf-8"))


def test_a_parameter_that_is_left_out_or_invented_is_noticed() -> None:
    text = (
        "def f(a, *, b):\n    '''Do.\n\n    Parameters\n    ----------\n    a, c : int\n    '''\n"
    )
    assert gaps(text) == ["f: b, c"]
    assert gaps(text.replace("a, c", "a, b")) == []
    assert gaps("def f(a, b): ...\n") == ["f: a, b"]


def test_an_attribute_that_is_left_out_is_noticed() -> None:
    text = "@dataclass\nclass K:\n    '''A thing.'''\n\n    size: float\n    _own: int\n"
    assert gaps(text) == ["K: size"]


def test_a_number_without_a_word_is_noticed() -> None:
    assert bare_constants("_TOL = 1e-6\n_MOST = 2 * 3\n'''Of all.'''\n") == ["_TOL"]


def test_a_tuned_number_without_a_unit_is_noticed() -> None:
    head = 'class Tuning:\n    """Two.\n\n    Attributes\n    ----------\n'
    text = head + "    few : int\n        Nodes [-].\n    seconds : float\n        Time.\n"
    assert unitless(text + '    """\n') == ["Tuning: seconds"]
    assert unitless(text.replace("Time", "Time [s]") + '    """\n') == []
    assert TUNED
