"""Scenarios and plans as plain data: what files hold, without the files."""

from __future__ import annotations

from collections.abc import Mapping

from radmpc.arguments import value_text
from radmpc.errors import ScenarioError
from radmpc.io.native.decoding import decode_scenario
from radmpc.io.native.encoding import encode_scenario
from radmpc.io.native.plan_file import decode_plan, encode_plan
from radmpc.io.ranges import PLAN_FORMAT, SCENARIO_FORMAT
from radmpc.model.given import check_scenario
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario

__all__ = ["from_dict", "to_dict"]


def to_dict(value: Scenario | Plan) -> dict[str, object]:
    """Return a scenario or a plan as plain data, ready for ``json.dumps``.

    Parameters
    ----------
    value : Scenario or Plan
        What to turn into data; of a result its ``plan`` or ``record``.

    Returns
    -------
    dict
        The content of its file (``radmpc/scenario/1`` or ``radmpc/plan/1``): dict, list, str,
        int, float, bool and None. `from_dict` returns an equal value, bit for bit.

    Raises
    ------
    ScenarioError
        If the scenario's ``source`` is not plain.
    ArgumentTypeError
        If it is neither a scenario nor a plan.

    Examples
    --------
    >>> from radmpc.experiments.families import paper
    >>> data = to_dict(paper(2, seed=1))
    >>> data["format"]
    'radmpc/scenario/1'
    >>> to_dict(from_dict(data)) == data
    True
    """
    if isinstance(value, Plan):
        return encode_plan(value)
    check_scenario(value, "value")
    return encode_scenario(value)


def from_dict(data: Mapping[str, object]) -> Scenario | Plan:
    """Return the scenario or the plan that plain data describe; its ``format`` says which.

    Parameters
    ----------
    data : mapping
        As in `to_dict`, or as parsed from a file.

    Returns
    -------
    Scenario or Plan
        Checked as when it is read from a file.

    Raises
    ------
    ScenarioError
        If the format is neither of the two, or anything is missing, unknown or not allowed; its
        path says where in the data.

    Examples
    --------
    >>> from radmpc.experiments.families import paper
    >>> data = to_dict(paper(2, seed=1)) | {"risk_bound": 0.01}
    >>> from_dict(data).risk_bound
    0.01
    """
    if not isinstance(data, Mapping):
        raise ScenarioError(f"must be a mapping, got {value_text(data)}")
    kind = data.get("format")
    if kind == PLAN_FORMAT:
        return decode_plan(data)
    if kind == SCENARIO_FORMAT:
        return decode_scenario(data)
    raise ScenarioError(
        f"must be {SCENARIO_FORMAT!r} or {PLAN_FORMAT!r}, got {value_text(kind)}", ("format",)
    )
