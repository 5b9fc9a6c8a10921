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
    kinds: dict[tuple[float | None, str | None], list[str]] = {}
    for v in vehicles:
        if v.shape is not None:
            names = kinds.setdefault((v.shape.covering, v.shape.parts), [])
            if v.shape.kind not in names:
                names.append(v.shape.kind)
    given = min((v.radius for v in vehicles if v.shape is not None), default=0.0)
    radius, how = (given, "") if asked is None else (asked, ", as asked,")
    told = []
    for (covering, parts), names in sorted(kinds.items(), key=lambda one: one[0][0] or 0.0):
        who = ", ".join(sorted(names))
        if covering is None:
            if asked is None:
                told.append(
                    f"shapes replaced by discs of {radius:g} m radius, a guess, their models are "
                    f"not known here (--radius states theirs): {who}"
                )
        elif radius < covering:
            told.append(
                f"shapes replaced by discs of {radius:g} m radius{how or ','} which do not cover "
                f"{parts} (--radius {covering:g} does): plans may let the published hulls "
                f"collide: {who}"
            )
    return told
