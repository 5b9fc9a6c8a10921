from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
import typer
from pages import PAGES, ROOT, Fence, fences, name_of, pages_with
from typer.testing import CliRunner

from radmpc.cli import app

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
QUOTED = re.compile(r"`(radmpc [^`]+)`")


def parse(words: list[str]) -> None:
    """Have the command line read what it would be given, and run nothing."""
    group = typer.main.get_command(app)
    name, *rest = words
    if name.startswith("-"):
        assert name in {option for param in group.params for option in param.opts}
        return
    command = group.commands[name]
    command.make_context(name, rest, parent=typer.Context(group, info_name="radmpc"))


def check(words: list[str], fence: Fence) -> None:
    """Run a command of radmpc; of others see that what they name is there."""
    program, *rest = words
    if program == "radmpc":
        parse(rest)
        if fence.reason is None:
            result = CliRunner().invoke(app, rest)
            assert result.exit_code == 0, f"{fence.where}: {' '.join(words)}\n{result.output}"
    elif program == "make":
        makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
        assert re.search(rf"^{rest[0]}:", makefile, re.M), f"{fence.where}: no target {rest[0]}"
    elif program == "python":
        script = (ROOT / rest[0]).read_text(encoding="utf-8")
        missing = [word for word in rest if word.startswith("--") and f'"{word}"' not in script]
        assert missing == [], f"{fence.where}: {rest[0]} has no {missing}"
    elif program == "pip":
        extras = re.findall(r"\[(\w+)\]", " ".join(rest))
        assert set(extras) <= set(PROJECT["optional-dependencies"]), fence.where
    else:
        assert fence.reason is not None, f"{fence.where}: {program} is not known here"


@pytest.mark.slow
@pytest.mark.parametrize("page", pages_with("sh"), ids=name_of)
def test_the_commands_of_a_page_do_what_they_should(page: Path, workbench: Path) -> None:
    for fence in fences(page, "sh"):
        for words in fence.commands:
            check(words, fence)


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_options_named_in_the_text_exist(page: Path) -> None:
    group = typer.main.get_command(app)
    names = set(group.commands)
    for quoted in QUOTED.findall(page.read_text(encoding="utf-8")):
        _, *words = quoted.split()
        command = group
        if words[0] in names:
            command = command.commands[words[0]]
        known = {option for param in command.params for option in param.opts} | {"--help"}
        used = {word for word in words if re.fullmatch(r"--?[a-z-]+", word)}
        assert used <= known, f"{name_of(page)}: {quoted}"
        assert words[0] in names or words[0].startswith("-") or words[0][0].isdigit(), quoted


def test_the_readme_begins_with_the_two_commands_of_make() -> None:
    made = [words[1] for f in fences(PAGES[0], "sh") for words in f.commands if words[0] == "make"]
    assert made[:2] == ["demo", "check"]
