"""A planner is a record of three choices about one programme."""

from __future__ import annotations

from dataclasses import dataclass, field

from radmpc.errors import ScenarioError
from radmpc.program.policy import Ira, Optimal, Policy, Pool
from radmpc.solvers.big_m import BigM
from radmpc.solvers.branch import Branch

__all__ = [
    "Centralized",
    "Certified",
    "Couplings",
    "Decomposition",
    "Planner",
    "Receding",
    "SolverChoice",
]

SolverChoice = BigM | Branch


@dataclass(frozen=True, slots=True)
class Centralized:
    """All vehicles in one programme."""

    def __str__(self) -> str:
        return "centralized"


@dataclass(frozen=True, slots=True)
class Receding:
    """One vehicle at a time, the others as temporal obstacles (paper, Algorithm 2).

    Attributes
    ----------
    covariances : {'schedule', 'reset'}
        Noise seen at absolute step k: that of the final plan, or as a controller that measures
        its state at every step sees it.
    """

    covariances: str = "schedule"

    def __post_init__(self) -> None:
        """Refuse unknown words."""
        if self.covariances not in {"schedule", "reset"}:
            raise ScenarioError(
                f"covariances must be 'schedule' or 'reset', got {self.covariances!r}"
            )

    def __str__(self) -> str:
        return "receding" if self.covariances == "schedule" else f"receding({self.covariances})"


@dataclass(frozen=True, slots=True)
class Couplings:
    """Sets that a receding approximation found to interact (paper, Algorithm 1).

    Attributes
    ----------
    threshold : float
        Ψ: vehicles are coupled if their collision probability in the approximation exceeds it.
    approximation : Receding
        How the approximation is made.
    approximation_policy : Pool
        Its risk policy.
    """

    threshold: float = 1e-6
    approximation: Receding = field(default_factory=Receding)
    approximation_policy: Pool = field(default_factory=Pool)

    def __post_init__(self) -> None:
        """Refuse thresholds that are no probability."""
        if not 0.0 <= self.threshold <= 1.0:
            raise ScenarioError(f"couplings threshold must be in [0, 1], got {self.threshold}")

    def __str__(self) -> str:
        return f"couplings({self.threshold:g})"


@dataclass(frozen=True, slots=True)
class Certified:
    """Sets merged where they collide, all at one price of risk, every plan certified."""

    def __str__(self) -> str:
        return "certified"


Decomposition = Centralized | Receding | Couplings | Certified


@dataclass(frozen=True, slots=True)
class Planner:
    """How a scenario is planned: risk policy × solver × decomposition.

    Attributes
    ----------
    policy : Policy
        How Δ becomes risks of rows.
    solver : BigM or Branch
        How the disjunctions are searched.
    decomposition : Decomposition
        Which vehicles are planned together.
    gap : float
        Relative gap at which each solve stops, > 0.

    Examples
    --------
    >>> from radmpc.program.policy import Uniform
    >>> print(Planner(Uniform(), Branch(), Centralized()))
    uniform, branch, centralized
    """

    policy: Policy
    solver: SolverChoice
    decomposition: Decomposition
    gap: float = 1e-3

    def __post_init__(self) -> None:
        """Refuse choices that do not go together."""
        if not 0.0 < self.gap < 1.0:
            raise ScenarioError(f"gap must lie between 0 and 1, got {self.gap}")
        if isinstance(self.policy, Optimal) != isinstance(self.decomposition, Certified):
            raise ScenarioError("policy 'optimal' and decomposition 'certified' need each other")
        if isinstance(self.policy, Optimal) and not isinstance(self.solver, Branch):
            raise ScenarioError("policy 'optimal' needs the solver 'branch'")
        pooled = isinstance(self.policy, Pool)
        if pooled and not isinstance(self.decomposition, Receding):
            raise ScenarioError("policy 'pool' needs the decomposition 'receding'")
        if isinstance(self.policy, Ira) and isinstance(self.decomposition, Receding):
            raise ScenarioError("policy 'ira' does not go with 'receding': use 'pool'")

    def __str__(self) -> str:
        return f"{self.policy}, {self.solver}, {self.decomposition}"
