"""Names that files share: none has a word that the glossary does without."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from pages import ROOT, section

SOURCE = ROOT / "src" / "radmpc"
GLOSSARY = ROOT / "docs" / "glossary.md"


def banned() -> dict[str, set[str]]:
    """Return the words of the glossary's last table, and the names that have them all the same."""
    table = section(GLOSSARY, "## Words that names do without")
    rows = re.findall(r"^\| ([a-z][^|]*) \| [^|]+ \|([^|]*)\|$", table, re.M)
    return {
        word: set(re.findall(r"`(\w+)`", names))
        for words, names in rows
        if words != "word"
        for word in words.split(", ")
    }


def words_of(name: str) -> set[str]:
    return set(re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower().split("_"))


def shared_names(tree: ast.Module) -> Iterator[str]:
    """Yield what other files can see of a module: what it defines, fields, methods, parameters."""
    for node in tree.body:
        yield from _defined(node)
        if isinstance(node, ast.ClassDef):
            for member in node.body:
                yield from _defined(member)


def _defined(node: ast.stmt) -> Iterator[str]:
    names: list[str] = []
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        names = [node.name]
        if not node.name.startswith("_") or node.name == "__init__":
            given = node.args
            names += [a.arg for a in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
    elif isinstance(node, ast.ClassDef):
        names = [node.name]
    elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
        names = [node.target.id]
    elif isinstance(node, ast.Assign):
        names = [target.id for target in node.targets if isinstance(target, ast.Name)]
    yield from (name for name in names if not name.startswith("_"))


def offenders(path: Path, text: str) -> set[str]:
    """Return the names of a module that have a word they should do without."""
    words = banned()
    return {
        name
        for name in (path.stem, *shared_names(ast.parse(text)))
        for word in words_of(name) & set(words)
        if name not in words[word]
    }


def test_names_that_files_share_do_without_these_words() -> None:
    paths = sorted(SOURCE.rglob("*.py"))
    assert len(paths) > 500
    found = {path.name: offenders(path, path.read_text("utf-8")) for path in paths}
    assert {name: names for name, names in found.items() if names} == {}


def test_every_name_that_is_excepted_is_there() -> None:
    there = {
        name
        for path in SOURCE.rglob("*.py")
        for name in shared_names(ast.parse(path.read_text("utf-8")))
    }
    excepted = set[str]().union(*banned().values())
    assert len(banned()) >= 15
    assert excepted
    assert sorted(excepted - there) == []


@pytest.mark.parametrize(
    "text",
    [
        "class KnownParts: ...",
        "def shortest_ways(): ...",
        "def plan(told): ...",
        "class A:\n    moves: int",
        "class A:\n    def __init__(self, *, room): ...",
        "ROOM = 1",
    ],
)
def test_a_word_to_do_without_is_noticed(text: str) -> None:
    assert offenders(Path("some.py"), text)


@pytest.mark.parametrize(
    "text",
    ["def f():\n    told = known = 1", "_ROOM = 1", "def _way(told): ...", "def plan(found): ..."],
)
def test_names_within_a_file_and_excepted_ones_pass(text: str) -> None:
    assert not offenders(Path("some.py"), text)


def test_a_module_is_a_name_too() -> None:
    assert offenders(Path("ways.py"), "") == {"ways"}
