"""What `--help` shows."""

from __future__ import annotations

import re

import pytest
import typer

from cli.conftest import Run
from radmpc.cli import app

COMMANDS = sorted(typer.main.get_command(app).commands)


def shown(run: Run, *words: str) -> str:
    """What a command prints, every line of a paragraph after the other."""
    result = run(*words, "--help")
    assert result.exit_code == 0
    return result.stdout


@pytest.mark.parametrize("name", COMMANDS)
def test_help_has_no_type_names_and_no_braces(run: Run, name: str) -> None:
    told = shown(run, name)
    assert re.findall(r"<[^>]*>|[{}]|\[\[|TEXT|INTEGER|VALUE$", told) == []


def test_arguments_stand_in_the_usage_as_they_are_typed(run: Run) -> None:
    for name, usage in (
        ("plan", "[OPTIONS] SCENARIO"),
        ("import", "[OPTIONS] FILE..."),
        ("serve", "[OPTIONS] [FILE]"),
        ("identify", "[OPTIONS] LOG..."),
    ):
        assert shown(run, name).splitlines()[0].split(":")[0] == "Usage"
        assert f" {name} {usage}\n" in shown(run, name)


def test_the_list_of_commands_has_whole_sentences(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    assert "..." not in shown(run).partition("Commands:")[2]


@pytest.mark.parametrize("name", COMMANDS)
def test_defaults_stand_in_brackets_and_descriptions_are_sentences(run: Run, name: str) -> None:
    for param in typer.main.get_command(app).commands[name].params:
        told = param.help
        assert not re.search(r"\([^)]*\)\.?$", told), told
        description = told.partition(" [default: ")[0]
        assert re.fullmatch(r"[A-Za-z].*[.…]", description), told
        assert not description.startswith(("Of ", "For ")), told


def test_help_says_what_is_not_obvious(run: Run) -> None:
    for name, told in (
        ("sweep", "an existing file is resumed"),
        ("fly", "[default: the planner's limit, 60 for certified]"),
        ("check", "The exit code is 0 for every valid scenario"),
        ("import", "--avoidance intervals|steps"),
        ("verify", "--avoidance intervals|steps"),
    ):
        assert told in " ".join(shown(run, name).split())
