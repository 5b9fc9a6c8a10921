"""Noise and feedback of vehicles from their logs.

What a step of the double integrator leaves unexplained, ``x⁺ − A x − B u`` with logged commands u,
or ``e⁺ − (A + B K) e`` with deviations e from a logged reference, is disturbance: its covariance,
drift, autocorrelation, tails, and the part that vehicles have in common.
"""

from radmpc.identification.identify import Identification, identify
from radmpc.identification.track import Track

__all__ = ["Identification", "Track", "identify"]
