"""Options that hold keys of a scenario and values: ``--set KEY=VALUE``, ``--over KEY=VALUE,…``."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.errors import ScenarioError, key_text
from radmpc.io.native.changes import key_path, key_value, split_key
from radmpc.io.text.files import shown

__all__ = ["axes_of", "changes_of"]


def changes_of(words: Sequence[str] | None) -> dict[str, object]:
    """Return the values by key that ``--set`` asks for.

    Parameters
    ----------
    words : sequence of str or None
        Each ``KEY=VALUE``.

    Raises
    ------
    ScenarioError
        If one is of another form, or a key stands twice.
    """
    pairs = _pairs("--set", words)
    return {key: key_value(f"--set {key_text(key)}", value) for key, value in pairs}


def axes_of(words: Sequence[str] | None) -> dict[str, tuple[object, ...]]:
    """Return the values by key that ``--over`` asks for.

    Parameters
    ----------
    words : sequence of str or None
        Each ``KEY=VALUE,VALUE,…``.

    Raises
    ------
    ScenarioError
        If one is of another form, or a key stands twice.
    """
    axes = {}
    for key, text in _pairs("--over", words):
        told = f"--over {key_text(key)}"
        values = key_value(told, f"[{text}]")
        if not isinstance(values, list) or not values:
            raise ScenarioError(f"{told}: must be values with commas, got {shown(text)}")
        axes[key] = tuple(values)
    return axes


def _pairs(option: str, words: Sequence[str] | None) -> list[tuple[str, str]]:
    """Return keys and the text of their values."""
    allowed = "KEY=VALUE" if option == "--set" else "KEY=VALUE,VALUE,..."
    pairs = []
    try:
        pairs = [split_key(word, allowed) for word in words or ()]
        for key, _ in pairs:
            key_path(key)
    except ScenarioError as error:
        raise ScenarioError(f"{option}: {error}") from error
    keys = [key for key, _ in pairs]
    twice = next((key for key in keys if keys.count(key) > 1), None)
    if twice is not None:
        raise ScenarioError(f"{option}: names {shown(twice)} twice")
    return pairs
