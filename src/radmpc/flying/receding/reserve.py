r"""What is left of a long mission's risk bound: windows are given shares of one account.

A window is a mission of its own, with a bound Δ' of its own and remaining risk W that never grows
on average. What remains of the long mission's is W and a *reserve* R that no window has; when a
window is given up for the next one, all of it is one sum again, of which the next window is given a
share:

.. math:: R := W + R - \Delta', \qquad \Delta' \le W + R .

So W + R stays what never grows on average, and begins with Δ: the probability of any collision in
all windows together is at most Δ.
"""

from __future__ import annotations

from radmpc.errors import RiskError
from radmpc.records import dataclass

__all__ = ["Reserve"]


@dataclass(frozen=True, slots=True)
class Reserve:
    """What no window has.

    Attributes
    ----------
    amount : float
        R, at least 0 [-].
    """

    amount: float

    def grant(self, wealth: float, window: int, left: int, most: float) -> float:
        """Return what the next window may be given: its share of the steps that are left.

        Parameters
        ----------
        wealth : float
            Remaining risk of the window that is given up [-].
        window, left : int
            Steps of the next window, and to the end of the mission.
        most : float
            What it may be given in any case [-].

        Returns
        -------
        float
            Δ' [-].
        """
        return min((wealth + self.amount) * min(window / left, 1.0), most)

    def given(self, wealth: float, bound: float) -> Reserve:
        """Return the reserve after a window was given up for one with a bound of its own.

        Parameters
        ----------
        wealth : float
            Remaining risk of the window that is given up [-].
        bound : float
            Δ' of the next one [-].

        Raises
        ------
        RiskError
            If there is not so much.
        """
        rest = wealth + self.amount - bound
        if rest < 0.0:
            raise RiskError(
                f"bound must be at most the {wealth + self.amount:.6g} that is left, got "
                f"{bound:.6g}"
            )
        return Reserve(rest)
