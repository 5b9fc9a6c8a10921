"""Docstrings as Markdown: their formulas are written for Sphinx, the pages want dollars.

And signatures of dataclasses, which readers of sources know by the standard library's name alone.
"""

from __future__ import annotations

import re
from typing import Any

from griffe import Docstring, Extension

_ROLE = re.compile(r":math:`([^`]+)`")
_BLOCK = re.compile(r"^(?P<indent> *)\.\. math:: *(?P<formula>.*(?:\n(?P=indent) +\S.*)*)", re.M)


def as_markdown(text: str) -> str:
    """Return a docstring with ``:math:`` and ``.. math::`` as TeX between dollars."""
    text = _BLOCK.sub(
        lambda m: f"{m['indent']}$${' '.join(m['formula'].split())}$$",
        text,
    )
    return _ROLE.sub(r"$\1$", text)


class SphinxFormulas(Extension):
    """Turns the docstrings as they are collected."""

    def on_instance(self, *, obj: Any, **_: Any) -> None:
        """Turn one."""
        if not obj.is_alias and isinstance(obj.docstring, Docstring):
            obj.docstring.value = as_markdown(obj.docstring.value)


class OwnDataclasses(Extension):
    """Reads the package's dataclasses as what they are to type checkers."""

    def on_alias_instance(self, *, alias: Any, **_: Any) -> None:
        """Read where one is imported."""
        alias.target_path = alias.target_path.replace("radmpc.records.", "dataclasses.")
