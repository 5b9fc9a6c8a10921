"""A planner is a record of three choices about one programme."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import get_args

from radmpc.arguments import check_word, is_number, told
from radmpc.errors import ScenarioError
from radmpc.program.policy import Ira, NoRisk, Optimal, Policy, Pool, Sigmas, Uniform
from radmpc.solvers.big_m import BigM
from radmpc.solvers.branch import Branch
from radmpc.solvers.rrt import Rrt

__all__ = [
    "Centralized",
    "Certified",
    "Couplings",
    "Decomposition",
    "Distance",
    "Planner",
    "Receding",
    "SolverChoice",
]

SolverChoice = BigM | Branch | Rrt


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
    arrivals : {'once', 'every_step'}
        When a vehicle in its goal lowers N*: when it first enters, or, as the pseudo-code has it,
        at every step that it is there.
    sigmas : float
        Half-side of temporal obstacles, beside the radius, in standard deviations. 3 bounds each
        axis; 3.44 the ellipse that holds as much in the plane (99.73 %).
    """

    covariances: str = "schedule"
    arrivals: str = "once"
    sigmas: float = 3.0

    def __post_init__(self) -> None:
        """Refuse unknown words."""
        check_word(self.covariances, ("schedule", "reset"), "covariances")
        check_word(self.arrivals, ("once", "every_step"), "arrivals")
        if not (is_number(self.sigmas) and 0.0 <= self.sigmas <= 10.0):
            raise ScenarioError(f"sigmas must lie between 0 and 10, got {told(self.sigmas)}")

    def __str__(self) -> str:
        options = [o for o in (self.covariances, self.arrivals) if o not in {"schedule", "once"}]
        options += [f"{self.sigmas:g} sigmas"] if self.sigmas != 3.0 else []
        return f"receding({', '.join(options)})" if options else "receding"


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
        if not (is_number(self.threshold) and 0.0 <= self.threshold <= 1.0):
            raise ScenarioError(
                f"couplings threshold must be in [0, 1], got {told(self.threshold)}"
            )
        for name, kind in (("approximation", Receding), ("approximation_policy", Pool)):
            part = getattr(self, name)
            if not isinstance(part, kind):
                raise ScenarioError(f"{name} must be a {kind.__name__}, got {told(part)}")

    def __str__(self) -> str:
        how = "" if self.approximation == Receding() else f", {self.approximation}"
        return f"couplings({self.threshold:g}{how})"


@dataclass(frozen=True, slots=True)
class Distance:
    """Sets of vehicles whose ways alone come close (Keviczky et al.).

    Attributes
    ----------
    meters : float
        Vehicles are coupled if they come within this distance, centre to centre [m].
    """

    meters: float = 5.0

    def __post_init__(self) -> None:
        """Refuse what is no distance."""
        if not (is_number(self.meters) and 0.0 <= self.meters < float("inf")):
            raise ScenarioError(
                f"distance must be a number of meters >= 0, got {told(self.meters)}"
            )

    def __str__(self) -> str:
        return f"distance({self.meters:g})"


@dataclass(frozen=True, slots=True)
class Certified:
    """Sets merged where they collide, all at one price of risk, every plan certified."""

    def __str__(self) -> str:
        return "certified"


Decomposition = Centralized | Receding | Couplings | Distance | Certified


@dataclass(frozen=True, slots=True)
class Planner:
    """How a scenario is planned: risk policy × solver × decomposition.

    Attributes
    ----------
    policy : Policy
        How Δ becomes risks of rows.
    solver : BigM, Branch or Rrt
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
        for name, kinds in (
            ("policy", Policy),
            ("solver", SolverChoice),
            ("decomposition", Decomposition),
        ):
            choice = getattr(self, name)
            if not isinstance(choice, kinds):
                known = ", ".join(kind.__name__ for kind in get_args(kinds))
                raise ScenarioError(f"{name} must be one of {known}, got {told(choice)}")
        if not (is_number(self.gap) and 0.0 < self.gap < 1.0):
            raise ScenarioError(f"gap must lie between 0 and 1, got {told(self.gap)}")
        if isinstance(self.policy, Optimal) != isinstance(self.decomposition, Certified):
            raise ScenarioError("policy 'optimal' and decomposition 'certified' need each other")
        if isinstance(self.policy, Optimal) and not isinstance(self.solver, Branch):
            raise ScenarioError("policy 'optimal' needs the solver 'branch'")
        pooled = isinstance(self.policy, Pool)
        if pooled and not isinstance(self.decomposition, Receding):
            raise ScenarioError("policy 'pool' needs the decomposition 'receding'")
        if isinstance(self.policy, Ira) and isinstance(self.decomposition, Receding):
            raise ScenarioError("policy 'ira' does not go with 'receding': use 'pool'")
        if isinstance(self.solver, Rrt):
            # The others take "none found" for "there is none", or costs for the least.
            if not isinstance(self.policy, NoRisk | Sigmas | Uniform):
                raise ScenarioError(
                    f"solver 'rrt' needs a policy 'none', 'sigmas' or 'uniform', got {self.policy}"
                )
            if isinstance(self.decomposition, Couplings):
                raise ScenarioError("solver 'rrt' does not go with 'couplings': use 'receding'")

    @property
    def bounds_risk(self) -> bool:
        """Whether its policy spends Δ; otherwise the certificate may be anything."""
        return not isinstance(self.policy, NoRisk | Sigmas)

    def __str__(self) -> str:
        return f"{self.policy}, {self.solver}, {self.decomposition}"
