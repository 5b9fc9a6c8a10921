"""Compiled code, where it was installed (`hatch_build.py`); its sources are in ``compiled/``.

``RADMPC_COMPILED=none`` in the environment leaves it aside, to compare.
"""

from __future__ import annotations

import os

try:
    from radmpc.solvers import _compiled
except ImportError:
    _compiled = None  # type: ignore[assignment]  # installed where there was no compiler
if os.environ.get("RADMPC_COMPILED") == "none":
    _compiled = None  # type: ignore[assignment]  # a module or None

__all__ = ["is_compiled"]


def is_compiled() -> bool:
    """Whether there is compiled code to use."""
    return _compiled is not None
