"""What is on the desk when the first page comes."""

from __future__ import annotations

from radmpc.serving.desk import files
from radmpc.serving.desk.desk import Desk

__all__ = ["open_first"]


async def open_first(desk: Desk, path: str) -> None:
    """Open the file that the command names.

    Parameters
    ----------
    desk : Desk
        Empty.
    path : str
        Relative to its folder.

    Raises
    ------
    CallError
        If it cannot be read.
    """
    await files.opened(desk, {"path": path})
