"""Pictures and films on request: matplotlib takes a third of a second to load."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from radmpc.console.files import check_output, writing
from radmpc.console.output import note
from radmpc.model.plan import Plan
from radmpc.notebook import lacking_signs, signs_text

__all__ = [
    "check_film",
    "check_picture",
    "drawing",
    "write_film",
    "write_ledger",
    "write_picture",
]


@contextmanager
def drawing(path: Path) -> Iterator[None]:
    """Draw into a file as within `writing`, and say on stderr in a line what is warned of.

    Python's own words would name a line of the code, once for every letter that a font lacks.

    Parameters
    ----------
    path : Path
        What is drawn.
    """
    with writing(path), warnings.catch_warnings(record=True) as caught:
        warnings.filterwarnings("always", category=UserWarning)
        with lacking_signs() as lacking:
            yield
    if lacking:
        note(f"{path}: {signs_text(lacking)}")
    for text in dict.fromkeys(str(one.message) for one in caught):
        note(f"{path}: {text}")


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
    from radmpc.plotting import check_film_path  # noqa: PLC0415 - matplotlib loads slowly

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
    from radmpc.plotting import check_figure_path  # noqa: PLC0415 - matplotlib loads slowly

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
    from radmpc.plotting import save_ledger  # noqa: PLC0415 - matplotlib loads slowly

    with drawing(path):
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
    from radmpc.plotting import save_figure  # noqa: PLC0415 - matplotlib loads slowly

    with drawing(path):
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
    from radmpc.plotting import save_animation  # noqa: PLC0415 - matplotlib loads slowly

    with drawing(path):
        save_animation(plan, path)
