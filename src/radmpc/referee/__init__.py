"""An independent judge of plans: it knows scenarios and plans, not how plans are made.

Each name is loaded when it is first used: certifying does not wait for the simulation.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from radmpc.front import late_names

if TYPE_CHECKING:
    from radmpc.referee.bound.certificate import Certificate, certify
    from radmpc.referee.simulation.simulation import Simulation, simulate
    from radmpc.referee.thinning import Thinned, thin

__all__ = ["Certificate", "Simulation", "Thinned", "certify", "simulate", "thin"]

_HOMES = {
    "referee.bound.certificate": ("Certificate", "certify"),
    "referee.simulation.simulation": ("Simulation", "simulate"),
    "referee.thinning": ("Thinned", "thin"),
}
__getattr__, __dir__ = late_names(__name__, _HOMES)
