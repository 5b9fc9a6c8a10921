"""How the time that a plan may take is shared among its phases."""

from __future__ import annotations

from radmpc.planners.certified.proof.tuning import TUNING as PROOF_TUNING
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.solvers.solution import Limits

__all__ = [
    "but_for_certificates",
    "but_for_faces",
    "but_for_proof",
    "limits_of_search",
]

_CERTIFICATES = 2
"""Certificates that may follow when it is time to stop [-]: that of a round of turning under way,
and that of the plan that is returned."""

_MOST_KEPT = 0.75
"""Share of the time left that is kept for them at most [-]."""


def but_for_certificates(limits: Limits, seconds: float) -> Limits:
    """Return limits that leave time for the last certificates.

    Parameters
    ----------
    limits : Limits
        Of the plan.
    seconds : float
        What a certificate takes [s].
    """
    left = limits.seconds_left
    if left == float("inf"):
        return limits
    return limits.within(left - min(_CERTIFICATES * seconds, _MOST_KEPT * left))


def limits_of_search(limits: Limits) -> Limits:
    """Return limits that leave time for turning half-spaces and for the proof.

    Parameters
    ----------
    limits : Limits
        Of the plan, as it begins.
    """
    seconds = limits.seconds_left
    if seconds == float("inf"):
        return limits
    kept = max(TUNING.time_share * seconds, min(TUNING.seconds, TUNING.most_time_share * seconds))
    return limits.within(seconds - kept - PROOF_TUNING.reserve * seconds)


def but_for_faces(search: Limits, limits: Limits, share: float) -> Limits:
    """Return limits of a search that leave time for bounding plans by faces after it.

    Parameters
    ----------
    search : Limits
        Of the search.
    limits : Limits
        Of the plan.
    share : float
        Of the time left [-].
    """
    left = limits.seconds_left
    if left == float("inf"):
        return search
    return search.within(max(search.seconds_left - share * left, 0.0))


def but_for_proof(limits: Limits, elapsed: float) -> Limits:
    """Return limits that leave time for the proof.

    Parameters
    ----------
    limits : Limits
        Of the plan.
    elapsed : float
        Since it began [s].
    """
    left = limits.seconds_left
    if left == float("inf"):
        return limits
    return limits.within(max(left - PROOF_TUNING.reserve * (left + elapsed), 0.0))
