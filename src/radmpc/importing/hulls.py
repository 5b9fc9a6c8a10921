"""Hulls that are no discs: what the discs around them cover, and what they do not."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.importing.problem import ForeignVehicle

__all__ = ["describe_hulls"]


def describe_hulls(vehicles: Sequence[ForeignVehicle], asked: float | None) -> list[str]:
    """Return what discs stand for where the published hulls are others.

    Parameters
    ----------
    vehicles : sequence of ForeignVehicle
        As published.
    asked : float or None
        Radius that is asked for, of all [m].

    Returns
    -------
    list of str
        A line for each kind of hull; none where all are discs, or those asked for cover them.
    """
    kinds: dict[tuple[float, str | None], list[str]] = {}
    for v in vehicles:
        if v.shape is not None:
            names = kinds.setdefault((v.radius, v.shape.covered), [])
            if v.shape.kind not in names:
                names.append(v.shape.kind)
    told = []
    for (radius, covered), names in sorted(kinds.items(), key=lambda one: one[0][0]):
        who = ", ".join(sorted(names))
        if covered is None:
            if asked is None:
                told.append(
                    f"shapes replaced by discs of {radius:g} m radius, a guess, their models are "
                    f"not known here (--radius states theirs): {who}"
                )
        elif asked is None:
            told.append(
                f"shapes replaced by discs of {radius:g} m radius, which cover {covered}: {who}"
            )
        elif asked < radius:
            told.append(
                f"discs of {asked:g} m radius, as asked, do not cover {covered} ({radius:g} m "
                f"would): plans may let the published hulls collide: {who}"
            )
    return told
