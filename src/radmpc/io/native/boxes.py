"""Boxes in scenario files, by their centers or their corners: goals and visits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from radmpc.arrays import Vector, as_axes, as_vector
from radmpc.errors import ScenarioError
from radmpc.io.native.schema import MOST_VISITS, GoalSpec, SurveySpec, VisitSpec

if TYPE_CHECKING:
    from radmpc.model.visits import Visit

__all__ = ["box_of", "build_visits"]


def box_of(spec: GoalSpec | VisitSpec, *path: str | int) -> tuple[Vector, Vector]:
    """Return the corners of the box of a goal or a visit.

    Parameters
    ----------
    spec : GoalSpec or VisitSpec
        What the file gives.
    *path : str or int
        Where it stands.

    Raises
    ------
    ScenarioError
        If it is no box in the plane or in space.
    """
    has_center = spec.center is not None
    has_width = "half_width" in spec.model_fields_set
    if spec.center is not None and spec.min is None and spec.max is None:
        center = as_vector(spec.center, path=(*path, "center"))
        half = as_axes(spec.half_width, center.size, (*path, "half_width"))
        if np.any(half < 0.0):
            raise ScenarioError(f"must be >= 0 m, got {spec.half_width}", (*path, "half_width"))
        lower, upper, key = center - half, center + half, "center"
    elif spec.min is not None and spec.max is not None and not has_center and not has_width:
        lower = as_vector(spec.min, path=(*path, "min"))
        upper, key = as_vector(spec.max, lower.size, (*path, "max")), "min"
    else:
        names = ("center", "half_width", "min", "max")
        given = [n for n in names if n in spec.model_fields_set and getattr(spec, n) is not None]
        raise ScenarioError(
            "needs either center (and half_width), or min and max; "
            f"got {' and '.join(given) or 'none of them'}",
            path,
        )
    if lower.size not in (2, 3):
        raise ScenarioError(f"must have 2 or 3 coordinates, got {lower.size}", (*path, key))
    return lower, upper


def build_visits(
    specs: Sequence[VisitSpec], survey: SurveySpec | None, dimension: int
) -> tuple[Visit, ...]:
    """Return what a vehicle visits: single boxes, then the lines of a survey.

    Parameters
    ----------
    specs : sequence of VisitSpec
        What the file gives.
    survey : SurveySpec or None
        An area to survey after that.
    dimension : int
        2 or 3.

    Raises
    ------
    ScenarioError
        With a path within the vehicle.
    """
    if not specs and survey is None:
        return ()
    from radmpc.model.visits import Visit  # noqa: PLC0415 - few visit anything

    visits = []
    for j, spec in enumerate(specs):
        lower, upper = box_of(spec, "via", j)
        try:
            visits.append(Visit(lower, upper, spec.between, spec.speed))
        except ScenarioError as error:
            raise error.under("via", j) from error
    if survey is not None:
        visits += _surveyed(survey, dimension)
    if len(visits) > MOST_VISITS:
        raise ScenarioError(
            f"must have at most {MOST_VISITS} visits with those of via, got {len(visits)}",
            ("survey",),
        )
    return tuple(visits)


def _surveyed(survey: SurveySpec, dimension: int) -> tuple[Visit, ...]:
    """Return the visits at the ends of a survey's lines."""
    at = ("survey", "altitude")
    if dimension == 3 and survey.altitude is None:
        raise ScenarioError("is required in space", at)
    if dimension == 2 and survey.altitude is not None:
        raise ScenarioError(f"must be left out in the plane, got {survey.altitude:g}", at)
    from radmpc.model.survey import survey_visits  # noqa: PLC0415 - few survey anything

    try:
        return survey_visits(
            survey.area,
            survey.spacing,
            survey.direction,
            half_width=survey.half_width,
            altitude=survey.altitude,
            speed=survey.speed,
        )
    except ScenarioError as error:
        raise error.under("survey") from error
