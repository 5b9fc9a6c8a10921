"""Formulas as MathML, made while building: browsers draw it without a script or a font."""

from __future__ import annotations

import html
import re
from itertools import cycle
from typing import Any

from latex2mathml.converter import convert

_INLINE = re.compile(r'<span class="arithmatex">\\\((.*?)\\\)</span>', re.S)
_BLOCK = re.compile(r'<div class="arithmatex">\s*\\\[(.*?)\\\]\s*</div>', re.S)

# Letters and accents that browsers draw well only with a mathematical font stand as themselves.
_LETTERS = {r"\mathcal N": "\N{MATHEMATICAL SCRIPT CAPITAL N}"}
_SIMILAR = ("<mi>&#x0007E;</mi>", "<mo>&#x0223C;</mo>")
# In a line of their own browsers stretch the first bar of a norm to the height of the line, and not
# the second, which stands below an index: both stay as they are, tight around what they hold.
_NORM_BAR = re.compile(r"<mo>&#x02016;</mo>")
_BAR = re.compile(r'<mover><mi>([a-z])</mi><mo stretchy="true">&#x000AF;</mo></mover>')


def formula(tex: str, display: str = "inline") -> str:
    """Return a formula as MathML.

    Parameters
    ----------
    tex : str
        As it stands between the dollars, with or without HTML's entities.
    display : {'inline', 'block'}
        Whether it stands in a line or by itself.

    Returns
    -------
    str
        A ``math`` element.
    """
    plain = html.unescape(tex)
    for name, letter in _LETTERS.items():
        plain = plain.replace(name, letter)
    drawn = convert(plain, display=display).replace(*_SIMILAR)
    forms = cycle(("prefix", "postfix"))
    drawn = _NORM_BAR.sub(
        lambda _: f'<mo stretchy="false" form="{next(forms)}">&#x02016;</mo>', drawn
    )
    return _BAR.sub(lambda match: f"<mi>{_italic(match[1])}\N{COMBINING MACRON}</mi>", drawn)


def _italic(letter: str) -> str:
    """Return a small letter as formulas have it."""
    if letter == "h":
        return "\N{PLANCK CONSTANT}"  # which took the place of the italic h
    return chr(ord("\N{MATHEMATICAL ITALIC SMALL A}") + ord(letter) - ord("a"))


def on_page_content(content: str, **_: Any) -> str:
    """Return a page with its formulas drawn."""
    content = _BLOCK.sub(lambda match: formula(match[1], "block"), content)
    return _INLINE.sub(lambda match: formula(match[1]), content)
