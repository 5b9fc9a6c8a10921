"""Names from files made fit for file names, ROS topics and XML, and still distinct."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable

__all__ = ["distinct", "file_part", "topic_part", "xml_text"]

# What XML 1.0 cannot hold, not even escaped.
_NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def file_part(name: str) -> str:
    """Return a name as part of a file name: letters, digits, ``-`` and ``_``."""
    return re.sub(r"[^\w-]", "_", name)[:60]


def topic_part(name: str) -> str:
    """Return a name as part of a ROS 2 topic: ASCII, no digit first, no ``__``."""
    part = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
    return part if part and not part[0].isdigit() else f"vehicle_{part}".rstrip("_")


def xml_text(text: str) -> str:
    """Return a text with a replacement mark for what XML cannot hold."""
    return _NOT_XML.sub("\N{REPLACEMENT CHARACTER}", text)


def distinct(names: Iterable[str], clean: Callable[[str], str]) -> dict[str, str]:
    """Return a clean name per name, with numbers where two would be the same.

    Parameters
    ----------
    names : iterable of str
        Distinct.
    clean : callable
        From a name to a clean one.

    Returns
    -------
    dict
        The clean names differ in more than upper and lower case: some file systems do not tell
        those apart.
    """
    answer: dict[str, str] = {}
    taken: set[str] = set()
    for name in names:
        part = candidate = clean(name)
        number = 1
        while candidate.casefold() in taken:
            number += 1
            candidate = f"{part}_{number}"
        taken.add(candidate.casefold())
        answer[name] = candidate
    return answer
