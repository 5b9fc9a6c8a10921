"""Shipped scenarios: the harbor, and templates to begin with."""

from __future__ import annotations

__all__ = ["TEMPLATES", "template"]

TEMPLATES = ("boats", "drones", "warehouse")
"""Names of the templates; the first is taken where none is named."""


def template(kind: str) -> str:
    """Return a template as its file has it, comments and all.

    Parameters
    ----------
    kind : str
        One of `TEMPLATES`.
    """
    from importlib.resources import files  # noqa: PLC0415 - the shell completes names alone

    return files(__name__).joinpath("templates", f"{kind}.yaml").read_text(encoding="utf-8")
