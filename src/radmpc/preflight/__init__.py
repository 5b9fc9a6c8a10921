"""What an operator should know of a scenario before it is planned, without planning it.

`outlook_of` looks at time, noise, control and narrow places; `concerns_of` says what to worry
about.
"""

from radmpc.preflight.concerns import Concern, concerns_of
from radmpc.preflight.outlook import Outlook, VehicleOutlook, outlook_of
from radmpc.preflight.places import Narrowest, Passage
from radmpc.preflight.reserve import Reserve

__all__ = [
    "Concern",
    "Narrowest",
    "Outlook",
    "Passage",
    "Reserve",
    "VehicleOutlook",
    "concerns_of",
    "outlook_of",
]
