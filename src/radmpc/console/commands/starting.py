"""A scenario to begin with, comments and all."""

from __future__ import annotations

from pathlib import Path

from radmpc import data
from radmpc.console.files import OutputError, check_output, writing
from radmpc.console.output import show
from radmpc.console.running.guard import Code
from radmpc.data import TEMPLATES
from radmpc.errors import ScenarioError
from radmpc.system.atomic import write_text

__all__ = ["run_new", "template"]

_SUFFIXES = (".yaml", ".yml")


def template(kind: str) -> str:
    """Return a template as its file has it.

    Parameters
    ----------
    kind : str
        Its name.

    Raises
    ------
    ScenarioError
        If there is none of that name.
    """
    if kind not in TEMPLATES:
        raise ScenarioError(f"KIND must be one of {', '.join(TEMPLATES)}, got {kind!r}")
    return data.template(kind)


def run_new(kind: str | None, output: Path | None) -> int:
    """Write a template; a file that is there stays.

    Parameters
    ----------
    kind : str or None
        Which one; None is the first.
    output : Path or None
        Where; None is the screen.

    Returns
    -------
    int
        The exit code.
    """
    text = template(TEMPLATES[0] if kind is None else kind)
    if output is None:
        show(text.rstrip("\n"))
        return Code.OK
    if output.suffix.lower() not in _SUFFIXES:
        raise OutputError(f"cannot write {output}: a template must end in .yaml or .yml")
    check_output(output)
    if output.exists() and not output.is_char_device():
        raise OutputError(f"cannot write {output}: it is there already")
    with writing(output):
        write_text(output, text)
    show(f"scenario written to {output}; next: radmpc plan {output} --figure plan.png")
    return Code.OK
