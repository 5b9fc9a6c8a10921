"""Every error as one line and an exit code."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Callable, Sequence
from enum import IntEnum
from typing import Any

import typer
from typer.core import TyperGroup

from radmpc.console.output import note, silence_closed_pipe
from radmpc.console.running.interrupt import (
    interrupt_on_termination,
    repeat_swallowed_interrupts,
)
from radmpc.console.running.usage import usage_line
from radmpc.errors import FileFormatError, NoPlanError, RadmpcError, SolverError

__all__ = ["Code", "GuardedCommands"]

_INTERRUPTED = 130
"""Exit code that typer makes of Ctrl-C, as shells do: 128 and the signal's number."""

# BadParameter's bases are the usage errors. Their own module is private in newer typer.
_USAGE_ERRORS = typer.BadParameter.__bases__
_usage_error: Any = _USAGE_ERRORS[0]


class Code(IntEnum):
    """Exit codes."""

    OK = 0
    """A plan was found and certified, or the check held."""
    NO = 1
    """No plan, a certificate above the bound, or a plan that does not hold."""
    BAD_INPUT = 2
    """Bad usage, or files that cannot be read, written or understood."""
    INTERNAL = 3
    """A defect of this program."""


class GuardedCommands(TyperGroup):
    """Commands whose every failure is one line on stderr and a documented exit code.

    ``--debug`` anywhere on the line adds the traceback.
    """

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        windows_expand_args: bool = True,
        **extra: Any,
    ) -> Any:
        """Run the command line.

        Parameters
        ----------
        args : sequence of str or None
            Arguments; None takes those of the process.
        prog_name, complete_var, windows_expand_args, extra
            As in typer.
        standalone_mode : bool
            Whether to exit the process with the code, rather than return it.

        Returns
        -------
        int
            The exit code.
        """
        words = list(sys.argv[1:] if args is None else args)
        is_debug = "--debug" in words
        words = [word for word in words if word != "--debug"]

        def run() -> object:
            return super(GuardedCommands, self).main(
                words, prog_name, complete_var, False, windows_expand_args, **extra
            )

        with silence_closed_pipe(), interrupt_on_termination(), repeat_swallowed_interrupts():
            code = _guarded(run, is_debug)
        if standalone_mode:
            sys.exit(code)
        return code

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read what stands before the command; name the place of an option that belongs after it.

        Parameters
        ----------
        ctx, args
            As in typer.

        Returns
        -------
        list of str
            What is left, the command first.

        Raises
        ------
        typer.BadParameter or one of its bases
            If the command line cannot be read.
        """
        words = list(args)
        try:
            return super().parse_args(ctx, args)
        except Exception as error:
            # Only one kind of usage error names an option that it does not know.
            option = getattr(error, "option_name", None)
            taker = next((word for word in words if option in self._options_of(word)), None)
            if taker is None:
                raise
            place = f"{ctx.command_path} {taker} {option}"
            raise _usage_error(
                f"Option {option} belongs after the command: '{place}'", ctx
            ) from None

    def _options_of(self, name: str) -> set[str]:
        """Return the options of a command; none where there is no such command."""
        command = self.commands.get(name)
        return {option for param in command.params for option in param.opts} if command else set()


def _guarded(run: Callable[[], object], is_debug: bool) -> int:
    """Return the code that a command returns or that its failure stands for."""
    try:
        code = run()
    except Exception as error:
        # The one place that catches everything: a defect must be a line and a code as well.
        if is_debug:
            traceback.print_exc()
        line, failure = _verdict(error)
        note(line)
        if isinstance(error, FileFormatError):
            # What else is wrong with the file, a line each.
            for other in getattr(error, "__notes__", ()):
                note(other)
        return failure
    if code == _INTERRUPTED:
        note("interrupted")
        return Code.NO
    return code if isinstance(code, int) else Code.OK


def _verdict(error: Exception) -> tuple[str, Code]:
    """Return the line and the exit code for an error."""
    if isinstance(error, _USAGE_ERRORS):
        return usage_line(error), Code.BAD_INPUT
    if isinstance(error, typer.Abort) or _is_interrupted_import(error):
        return "interrupted", Code.NO
    if isinstance(error, NoPlanError):
        return str(error), Code.NO
    if isinstance(error, RadmpcError) and not isinstance(error, SolverError):
        return str(error), Code.BAD_INPUT
    if isinstance(error, OSError):
        return _file_line(error), Code.BAD_INPUT
    what = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    return f"internal error: {what} (--debug shows where)", Code.INTERNAL


def _is_interrupted_import(error: BaseException | None) -> bool:
    """Whether Ctrl-C fell into the initialization of a compiled module or of a class.

    The former hides it in an ImportError, the latter, up to Python 3.11, in a RuntimeError.
    """
    if not isinstance(error, ImportError | RuntimeError):
        return False
    cause = error.__cause__ or error.__context__
    while cause is not None:
        if isinstance(cause, KeyboardInterrupt):
            return True
        cause = cause.__cause__ or cause.__context__
    return False


def _file_line(error: OSError) -> str:
    """Return which file could not be read or written and why."""
    reason = error.strerror or str(error) or type(error).__name__
    if error.filename is None:
        return reason
    return f"{os.fspath(error.filename)}: {reason}"
