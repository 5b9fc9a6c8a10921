r"""How the reserve for the sagitta is shared between the two ends of an interval.

A chord margin :math:`(1-s)\,m_0 + s\,m_1` clears a parabola :math:`4 s (1-s)\,b` on [0, 1] if and
only if :math:`\sqrt{m_0} + \sqrt{m_1} \ge 2\sqrt b`, that is, if and only if for some share θ in
[0, 1]

.. math:: m_0 \ge 4 b\,\theta^2 \quad\text{and}\quad m_1 \ge 4 b\,(1-\theta)^2 .

Each θ gives linear rows; b at both ends (θ = ½) is one of them. An end whose place is known, such
as a start, often has room for all of the reserve or for none: that is what other shares are for.
"""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Vector

__all__ = ["shares_of_reserve"]

_LEAST_GAIN = 0.02
"""Difference of shares below which a second one is not worth an alternative [-]."""


def shares_of_reserve(near: Vector, far: Vector, bow: Vector) -> list[Vector]:
    """Return the shares θ of the near end that are worth an alternative each.

    Parameters
    ----------
    near, far : (w, f) array
        What each end of each window keeps to spare, wherever the vehicles may be [m]; negative
        where it may lack.
    bow : (w, f) array
        Largest sagitta towards the face [m].

    Returns
    -------
    list of (w, f) array
        The first always; others NaN where they are not worth it.
    """
    curved = bow > 0.0
    scale = np.where(curved, 4.0 * bow, 1.0)
    # The largest shares that the ends can keep at no cost whatever the vehicles do.
    free_near = np.where(curved, np.sqrt(np.clip(near / scale, 0.0, 1.0)), 0.5)
    free_far = np.where(curved, np.sqrt(np.clip(far / scale, 0.0, 1.0)), 0.5)
    usual = np.full(bow.shape, 0.5)
    usual = np.where(free_far > 0.5, 1.0 - free_far, usual)
    usual = np.where(free_near > 0.5, free_near, usual)
    # A start is where it is, and a goal nearly so: what they can spare is known beforehand.
    first, last = (np.full(bow.shape, np.nan) for _ in range(2))
    is_short = curved[0] & (free_near[0] < 0.5 - _LEAST_GAIN) & (usual[0] > free_near[0])
    first[0] = np.where(is_short, free_near[0], np.nan)
    is_short = curved[-1] & (free_far[-1] < 0.5 - _LEAST_GAIN) & (usual[-1] < 1.0 - free_far[-1])
    last[-1] = np.where(is_short, 1.0 - free_far[-1], np.nan)
    extra = [share for share in (first, last) if np.isfinite(share).any()]
    return [usual, *extra]
