"""Commands as their users see them: help in their words, and stdout for data alone."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from typer.core import TyperCommand

from radmpc.console.output import reports_beside

__all__ = ["PlainCommand"]

_TYPES = {
    "path": "FILE",
    "str": "NAME",
    "list[str]": "NAME",
    "int": "N",
    "int range": "N",
    "float": "X",
    "float range": "SECONDS",
}
"""What values are called, by their types."""

_OPTIONS = {
    "--out": "FOLDER",
    "--folder": "FOLDER",
    "--dask": "ADDRESS",
    "--planners": "NAMES",
    "--columns": "NAMES",
    "--avoidance": "intervals|steps",
    "--option": "KEY=VALUE",
    "--to": "FORMAT",
    "--view": "VIEW",
    "--origin": "PLACE",
    "--dt": "SECONDS",
    "--noise": "METERS",
    "--radius": "METERS",
    "--altitude": "METERS",
    "--tolerance": "METERS",
    "--risk-bound": "RISK",
    "--gap": "SHARE",
}
"""What the values of options are called whose types tell too little."""


class PlainCommand(TyperCommand):
    """A command whose help names values in words of its users.

    It reports on stderr where stdout is one of its outputs.
    """

    def invoke(self, ctx: Any) -> Any:
        """Run the command.

        Parameters
        ----------
        ctx
            As in typer.

        Returns
        -------
        int
            The exit code.
        """
        # Arguments are what is read, options what is written.
        options = [param.name for param in self.params if param.param_type_name == "option"]
        paths = [ctx.params.get(name) for name in options]
        with reports_beside(path for path in paths if isinstance(path, Path)):
            return super().invoke(ctx)

    def collect_usage_pieces(self, ctx: Any) -> list[str]:
        """Return what stands behind the command's name, without braces around what is required.

        Parameters
        ----------
        ctx
            As in typer.

        Returns
        -------
        list of str
            Options and arguments.
        """
        pieces = super().collect_usage_pieces(ctx)
        return [re.sub(r"^\{(.*)\}(\.*)$", r"\1\2", piece) for piece in pieces]

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write arguments and options.

        Parameters
        ----------
        ctx, formatter
            As in typer.
        """
        told: dict[str, list[tuple[str, str]]] = {"Arguments": [], "Options": []}
        for param in self.get_params(ctx):
            record = param.get_help_record(ctx)
            if record is not None:
                is_argument = param.param_type_name == "argument"
                section = told["Arguments" if is_argument else "Options"]
                section.append((_named(record[0], is_argument=is_argument), record[1]))
        for title, rows in told.items():
            if rows:
                with formatter.section(title):
                    formatter.write_dl(rows)


def _named(name: str, *, is_argument: bool) -> str:
    """Return an argument or an option with its value's name instead of its type's."""
    found = re.fullmatch(r"(.*) <(.*)>", name)
    if found is None:
        return name
    words, kind = found.groups()
    if is_argument:
        return words
    return f"{words} {_OPTIONS.get(words.split(', ')[-1], _TYPES.get(kind, 'VALUE'))}"
