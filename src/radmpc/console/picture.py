"""Pictures and films on request: matplotlib takes a third of a second to load."""

from __future__ import annotations

from pathlib import Path

from radmpc.console.files import check_output, writing
from radmpc.model.plan import Plan

__all__ = ["check_film", "check_picture", "write_film", "write_ledger", "write_picture"]


def check_film(path: Path | None) -> None:
    """Refuse a film that could not be written.

    Raises
    ------
    FileFormatError
        If its format is unknown, or needs a program that is not there.
    OutputError
        If its folder is missing or not writable.
    """
    if path is None:
        return
    from radmpc.plotting import check_film_path  # noqa: PLC0415 - see the file's first line

    check_film_path(path)
    check_output(path)


def check_picture(path: Path | None) -> None:
    """Refuse a picture that could not be written.

    Raises
    ------
    FileFormatError
        If its format is unknown.
    OutputError
        If its folder is missing or not writable.
    """
    if path is None:
        return
    from radmpc.plotting import check_figure_path  # noqa: PLC0415 - see the file's first line

    check_figure_path(path)
    check_output(path)


def write_ledger(plan: Plan, path: Path) -> None:
    """Draw where a plan's risk goes into a file.

    Parameters
    ----------
    plan : Plan
        Whose ledger is drawn.
    path : Path
        The file; its ending chooses the format.
    """
    from radmpc.plotting import save_ledger  # noqa: PLC0415 - see the file's first line

    with writing(path):
        save_ledger(plan, path)


def write_picture(plan: Plan, path: Path) -> None:
    """Draw a plan, or what there is without one, into a file.

    Parameters
    ----------
    plan : Plan
        What is drawn.
    path : Path
        The file; its ending chooses the format.
    """
    from radmpc.plotting import save_figure  # noqa: PLC0415 - see the file's first line

    with writing(path):
        save_figure(plan, path)


def write_film(plan: Plan, path: Path) -> None:
    """Draw a plan as a film into a file.

    Parameters
    ----------
    plan : Plan
        What is drawn.
    path : Path
        The file; its ending chooses the format.
    """
    from radmpc.plotting import save_animation  # noqa: PLC0415 - see the file's first line

    with writing(path):
        save_animation(plan, path)
