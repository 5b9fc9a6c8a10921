"""The page's view of values in notebooks: map, timeline and ledger, by the page's own code."""

from __future__ import annotations

from typing import TYPE_CHECKING

from radmpc.front import late_names

if TYPE_CHECKING:
    from radmpc.viewing.view import view

__all__ = ["view"]

_HOMES = {"viewing.view": ("view",)}
__getattr__, __dir__ = late_names(__name__, _HOMES)
