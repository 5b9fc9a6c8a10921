"""A page in the browser: for drawing, planning, watching and flying."""

from __future__ import annotations

from pathlib import Path

from radmpc.console.files import OutputError, file_of
from radmpc.console.output import show
from radmpc.console.running.guard import Code
from radmpc.errors import FileFormatError
from radmpc.serving.starting import Serving, check_extra, listening, serve

__all__ = ["run_serve"]


def run_serve(source: Path | None, port: int, folder: Path | None, *, opens: bool) -> int:
    """Serve the page until Ctrl-C.

    Parameters
    ----------
    source : Path or None
        A scenario, a plan, a flight or a chart to begin with.
    port : int
        0 is any that is free.
    folder : Path or None
        Where files are read and written; None is where the file is, or here.
    opens : bool
        Whether the browser is asked to open the page.

    Returns
    -------
    int
        The exit code.

    Raises
    ------
    ServingError
        If a package is missing, or the port is taken.
    FileFormatError, OutputError
        If the file or the folder cannot be used.
    """
    check_extra()
    if folder is None:
        folder = Path() if source is None else source.parent
    if not folder.is_dir():
        raise OutputError(f"{folder}: there is no such folder")
    name = None if source is None else _name(source, folder)

    def said(address: str) -> None:
        show(address)
        if opens:
            import webbrowser  # noqa: PLC0415 - few ask for it

            webbrowser.open(address)

    with listening(port) as heard:
        serve(Serving(folder, name), heard, said)
    return Code.OK


def _name(source: Path, folder: Path) -> str:
    """Return a file's path within the folder."""
    if source.is_dir():
        raise FileFormatError(f"{source}: is a folder, not a file: use --folder {source}")
    if not source.is_file():
        raise FileFormatError(f"{source}: there is no such file")
    place = file_of(source)
    if not place.is_relative_to(file_of(folder)):
        raise OutputError(f"{source}: is not in the folder {folder}")
    return place.relative_to(file_of(folder)).as_posix()
