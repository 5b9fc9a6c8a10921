"""What feedback keeps back of the control, in words."""

from __future__ import annotations

import numpy as np

from radmpc.program.condensed import CondensedModel

__all__ = ["overdrawn_texts", "reserve_reason", "reserve_text"]

_NOTICED = 0.5
"""Share of the control limit from which on what feedback reserves is worth telling [-]."""


def reserve_reason(model: CondensedModel) -> str | None:
    """Say how much control the feedback keeps back, where that is much of it.

    Returns
    -------
    str or None
        What follows "the feedback"; None without feedback, or where it takes little.
    """
    if model.vehicle.gain is None:
        return None
    shares = 1.0 - model.control_bounds / model.vehicle.control_limit
    return reserve_text(model) if shares.max() >= _NOTICED else None


def reserve_text(model: CondensedModel) -> str:
    """Return how much control the feedback keeps back, where it keeps back most.

    Parameters
    ----------
    model : CondensedModel
        A vehicle with feedback.

    Returns
    -------
    str
        What follows "the feedback".
    """
    vehicle = model.vehicle
    reserves = vehicle.control_limit - model.control_bounds
    step, axis = (
        int(k)
        for k in np.unravel_index((reserves / vehicle.control_limit).argmax(), reserves.shape)
    )
    kept, limit = float(reserves[step, axis]), float(vehicle.control_limit[axis])
    unit = " m/s²" if vehicle.system.is_double_integrator else ""
    return (
        f"keeps back {kept:.3g} of {limit:.3g}{unit} on axis {axis} at step {step} "
        f"({vehicle.control_sigmas:g} standard deviations)"
    )


def overdrawn_texts(model: CondensedModel) -> tuple[str, str] | None:
    """Say that feedback takes more control than there is."""
    if np.all(model.control_bounds >= 0.0):
        return None
    step, axis = (int(k) for k in np.argwhere(model.control_bounds < 0.0)[0])
    vehicle = model.vehicle
    limit = float(vehicle.control_limit[axis])
    unit = " m/s²" if vehicle.system.is_double_integrator else ""
    text = (
        f"has no control left to steer: at step {step} the feedback alone takes more than control "
        f"axis {axis} allows, it keeps back {limit - model.control_bounds[step, axis]:.3g} of "
        f"{limit:.3g}{unit} ({vehicle.control_sigmas:g} standard deviations)."
    )
    return text, text.replace("has no", "have no", 1)
