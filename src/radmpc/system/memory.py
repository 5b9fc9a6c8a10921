"""Memory that was freed, handed back to the system."""

from __future__ import annotations

import ctypes
from contextlib import suppress

__all__ = ["hand_back_freed"]


def hand_back_freed() -> None:
    """Hand memory that was freed back to the system, where it can be told to (glibc).

    It keeps what lies between pieces still in use, in the hope of more to come: after a large
    phase a third of what a process takes. Handing 100 MB back takes some 10 ms.
    """
    with suppress(OSError, AttributeError):
        ctypes.CDLL(None).malloc_trim(0)
