r"""How the reserve for the sagitta is shared between the two ends of an interval.

A chord margin :math:`(1-s)\,m_0 + s\,m_1` clears a parabola :math:`4 s (1-s)\,b` on [0, 1] if and
only if :math:`\sqrt{m_0} + \sqrt{m_1} \ge 2\sqrt b`, that is, if and only if for some share θ in
[0, 1]

.. math:: m_0 \ge 4 b\,\theta^2 \quad\text{and}\quad m_1 \ge 4 b\,(1-\theta)^2 .

Each θ gives linear rows; b at both ends (θ = ½) is one of them. An end whose position is fixed,
such as a start, often has slack for all of the reserve or for none: hence other shares.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Indices, Vector

__all__ = ["shares_of_reserve"]

_LEAST_GAIN = 0.02
"""Difference of shares below which a second one is not worth an alternative [-]."""

_LESS = 0.25
"""Share that a tight start or goal is offered beside those that its slack allows [-]: those assume
the worst sagitta, and most are smaller."""


def shares_of_reserve(
    near: Sequence[Vector],
    far: Sequence[Vector],
    sagitta: Vector,
    ends: tuple[Indices, Indices],
) -> list[Vector]:
    """Return the shares θ of the near end that are worth an alternative each.

    Parameters
    ----------
    near, far : sequence of (w, f) array
        What each end of each window keeps to spare, wherever the vehicles may be [m]; negative
        where it may lack. The first beyond what is charged nothing, the others at some risk.
    sagitta : (w, f) array
        Largest sagitta toward the face [m].
    ends : tuple of (n,) int array
        The first and the last window of each of n things that are avoided.

    Returns
    -------
    list of (w, f) array
        The first always; others NaN where they are not worth it.
    """
    curved = sagitta > 0.0
    scale = np.where(curved, 4.0 * sagitta, 1.0)

    def largest(spare: Vector) -> Vector:
        """Return the largest share that an end can keep of the worst sagitta."""
        return np.where(curved, np.sqrt(np.clip(spare / scale, 0.0, 1.0)), 0.5)

    free_near, free_far = largest(near[0]), largest(far[0])
    usual = np.full(sagitta.shape, 0.5)
    usual = np.where(free_far > 0.5, 1.0 - free_far, usual)
    usual = np.where(free_near > 0.5, free_near, usual)
    shares = [usual]
    for is_first, window, spares in ((True, ends[0], near), (False, ends[1], far)):
        # Positions at the start are fixed, at the goal nearly so: their slack is known beforehand.
        own: Vector = usual[window] if is_first else 1.0 - usual[window]
        rooms = [largest(spare)[window] for spare in spares]
        tried = [own]
        for less in (*rooms, np.where(rooms[-1] < own, _LESS, own)):
            is_new = np.all([np.abs(less - other) > _LEAST_GAIN for other in tried], axis=0)
            is_worth = is_new & (less < own) & curved[window]
            tried.append(np.where(is_worth, less, own))
            if is_worth.any():
                share = np.full(sagitta.shape, np.nan)
                share[window] = np.where(is_worth, less if is_first else 1.0 - less, np.nan)
                shares.append(share)
    return shares
