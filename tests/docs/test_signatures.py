"""Signatures that are written out for type checkers beside those that dataclasses make."""

from __future__ import annotations

import ast
import inspect
import textwrap
from pathlib import Path

import pytest
from programs import write_programs

import radmpc

CONVERTING = [
    radmpc.Goal,
    radmpc.LinearSystem,
    radmpc.Scenario,
    radmpc.Trajectory,
    radmpc.Vehicle,
    radmpc.Workspace,
]


def written(kind: type) -> list[tuple[str, str | None]]:
    """Parameters and defaults that type checkers see."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(kind)))
    (init,) = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef) and node.name == "__init__"
    ]
    assert not init.args.kwonlyargs
    names = [arg.arg for arg in init.args.args if arg.arg != "self"]
    defaults = [ast.unparse(value) for value in init.args.defaults]
    return list(zip(names, [None] * (len(names) - len(defaults)) + defaults, strict=True))


def made(kind: type) -> list[tuple[str, str | None]]:
    """Parameters and defaults that the dataclass has when it runs."""
    return [
        (name, None if parameter.default is inspect.Parameter.empty else repr(parameter.default))
        for name, parameter in inspect.signature(kind).parameters.items()
    ]


@pytest.mark.parametrize("kind", CONVERTING, ids=lambda kind: kind.__name__)
def test_type_checkers_see_the_arguments_that_there_are(kind: type) -> None:
    assert written(kind) == made(kind)


def test_an_error_in_a_page_s_program_names_the_line_of_the_page(tmp_path: Path) -> None:
    page = Path(__file__).parent.parent.parent / "docs" / "index.md"
    lines = page.read_text(encoding="utf-8").splitlines()
    (tmp_path / "docs_gone.py").write_text("of a page that is no more", encoding="utf-8")
    programs = {path.name: path for path in write_programs(tmp_path)}
    code = programs["docs_index.py"].read_text(encoding="utf-8").splitlines()
    assert [line for line in code if line]
    assert all(line == lines[number] for number, line in enumerate(code) if line)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(programs)
