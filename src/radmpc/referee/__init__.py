"""An independent judge of plans: it knows scenarios and plans, not how plans are made."""

from radmpc.referee.bound.certificate import Certificate, certify
from radmpc.referee.simulation.simulation import Simulation, simulate

__all__ = ["Certificate", "Simulation", "certify", "simulate"]
