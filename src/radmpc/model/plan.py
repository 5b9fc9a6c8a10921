"""A plan: what a plan file holds. No optimizer objects, no file format."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from typing import TYPE_CHECKING

import numpy.typing as npt

from radmpc.arguments import field_integer, field_number, field_parts, field_text, one, value_text
from radmpc.arrays import Frozen, Matrix, Tensor, as_array, as_matrix
from radmpc.errors import ScenarioError
from radmpc.model.ledger import Cause, LedgerRow, Risk, bound_texts, put_numbers, put_parts
from radmpc.model.relations.couplings import Coupling, Reason
from radmpc.model.scenario import Scenario
from radmpc.notebook import html_table, listed
from radmpc.records import FrozenDict, dataclass, field
from radmpc.wording import percent, short_cost

__all__ = [
    "Cause",
    "Coupling",
    "FirstPlan",
    "LedgerRow",
    "Plan",
    "Reason",
    "Risk",
    "Status",
    "Trajectory",
]


class Status(Enum):
    """How planning ended; the value is the word in plan files."""

    OPTIMAL = "optimal"
    FEASIBLE = "feasible"
    INFEASIBLE = "infeasible"
    LIMIT = "limit"

    @property
    def sentence(self) -> str:
        """What a user needs to know, advice included."""
        return {
            Status.OPTIMAL: "plan found, proven optimal for the union bound, within the gap",
            Status.FEASIBLE: "plan found, without a proof that it is the best",
            Status.INFEASIBLE: "no plan found",
            Status.LIMIT: "ended without a plan, and without a proof that there is none",
        }[self]

    def sentence_after(self, stopped_by: str | None) -> str:
        """Return the same where a limit ended the search, which it names.

        Parameters
        ----------
        stopped_by : str or None
            A clause such as "the time limit of 60 s was reached"; None where no limit did.

        Returns
        -------
        str
            `sentence` where the limit makes no difference.
        """
        if stopped_by is not None and self is Status.FEASIBLE:
            return f"plan found, but {stopped_by} before a proof that it is the best"
        if stopped_by is not None and self is Status.LIMIT:
            return f"ended before any plan was found: {stopped_by}"
        return self.sentence


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory(Frozen):
    """One vehicle's part of a plan.

    Attributes
    ----------
    name : str
        The vehicle.
    controls : (T, m) array
        Nominal controls ū; for a double integrator [m/s²].
    means : (T+1, n) array
        Mean states x̄; for a double integrator positions [m] and velocities [m/s].
    covariances : (T+1, n, n) array
        State covariances Σ [m², m²/s²].
    gain : (m, n) array or None
        Feedback in use.
    """

    name: str
    controls: Matrix
    means: Matrix
    covariances: Tensor
    gain: Matrix | None = None

    if TYPE_CHECKING:  # what it takes is wider than what it holds

        def __init__(
            self,
            name: str,
            controls: npt.ArrayLike,
            means: npt.ArrayLike,
            covariances: npt.ArrayLike,
            gain: npt.ArrayLike | None = None,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Freeze the arrays."""
        field_text(self.name, ("name",))
        put = object.__setattr__
        put(self, "controls", as_matrix(self.controls, path=("controls",)))
        put(self, "means", as_matrix(self.means, path=("means",)))
        put(self, "covariances", as_array(self.covariances, (None, None, None), ("covariances",)))
        if self.gain is not None:
            put(self, "gain", as_matrix(self.gain, path=("gain",)))


@dataclass(frozen=True, slots=True)
class FirstPlan:
    """When the first certified plan was there, and what it cost.

    Attributes
    ----------
    seconds : float
        Since planning began.
    cost : float
        ``Σ weight · ‖u‖₁``.
    """

    seconds: float
    cost: float

    def __post_init__(self) -> None:
        """Refuse what are no numbers."""
        for name in ("seconds", "cost"):
            object.__setattr__(self, name, field_number(getattr(self, name), (name,)))


def _names(given: object) -> tuple[str, ...]:
    """Return a set of vehicles as a tuple of names."""
    names = field_parts(given, "a sequence of names", ("sets",))
    for name in names:
        field_text(name, ("sets",))
    return names  # type: ignore[return-value] # all text


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Everything a plan file holds; ``trajectories`` is empty where no plan was found.

    Attributes
    ----------
    scenario : Scenario
        The scenario planned.
    planner : str
        The planner's record in one line.
    seed : int or None
        Seed of every random choice; None if the caller gave a generator.
    status : Status
        How planning ended.
    cost : float or None
        ``Σ weight · ‖u‖₁``; None without a plan.
    lower_bound : float or None
        Proven least cost of plans by the program's own faces whose union bound is at most Δ, where
        there is a proof. Plans by other half-spaces may cost less.
    risk : Risk
        Bound, certificate and ledger.
    sets : tuple of tuple of str
        Which vehicles were planned together.
    seconds : mapping
        Seconds per stage and ``total``. A copy that does not change.
    versions : mapping
        Package versions used; likewise.
    explanation : str or None
        Why there is no plan, or what it took to find this one.
    trajectories : tuple of Trajectory
        One per vehicle, in the scenario's order; empty without a plan.
    couplings : tuple of Coupling
        Why the vehicles of a set were planned together; none in a set that was planned together
        from the start.
    stopped_by : str or None
        The limit that ended the search, as a clause: "the time limit of 60 s was reached"; None
        where the search ended by itself.
    certified_lower_bound : float or None
        Proven least cost of any plan that the referee would certify, whatever its half-spaces,
        where there is a proof.
    first : FirstPlan or None
        The first certified plan; None where the planner does not tell of it.
    """

    scenario: Scenario
    planner: str
    seed: int | None
    status: Status
    cost: float | None
    lower_bound: float | None
    risk: Risk
    sets: tuple[tuple[str, ...], ...]
    seconds: Mapping[str, float] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)
    explanation: str | None = None
    trajectories: tuple[Trajectory, ...] = ()
    couplings: tuple[Coupling, ...] = ()
    stopped_by: str | None = None
    certified_lower_bound: float | None = None
    first: FirstPlan | None = None

    def __post_init__(self) -> None:
        """Refuse parts of another kind, whatever they say; sequences become tuples."""
        for name, kind in (("scenario", Scenario), ("status", Status), ("risk", Risk)):
            part = getattr(self, name)
            if not isinstance(part, kind):
                raise ScenarioError(f"must be {one(kind)}, got {value_text(part)}", (name,))
        if not isinstance(self.first, FirstPlan | None):
            raise ScenarioError(f"must be a FirstPlan, got {value_text(self.first)}", ("first",))
        field_text(self.planner, ("planner",))
        for name in ("explanation", "stopped_by"):
            if getattr(self, name) is not None:
                field_text(getattr(self, name), (name,))
        if self.seed is not None and type(self.seed) is not int:
            object.__setattr__(self, "seed", field_integer(self.seed, ("seed",)))
        put_numbers(self, ("cost", "lower_bound", "certified_lower_bound"))
        put_parts(self, "trajectories", Trajectory)
        put_parts(self, "couplings", Coupling)
        groups = field_parts(self.sets, "sequences of names", ("sets",))
        object.__setattr__(self, "sets", tuple(_names(group) for group in groups))
        for name in ("seconds", "versions"):
            given = getattr(self, name)
            if not isinstance(given, Mapping):
                raise ScenarioError(f"must be a mapping, got {value_text(given)}", (name,))
            if type(given) is not FrozenDict:
                object.__setattr__(self, name, FrozenDict(given))

    @property
    def certified_gap(self) -> float | None:
        """Share of the cost that any certified plan could save at most [-]; None if not known."""
        if self.cost is None or self.certified_lower_bound is None:
            return None
        if self.cost <= 0.0:
            return 0.0
        return max(self.cost - self.certified_lower_bound, 0.0) / self.cost

    @property
    def status_sentence(self) -> str:
        """How planning ended in words: what could still be saved, and the limit that ended it."""
        sentence = self.status.sentence_after(self.stopped_by)
        gap = self.certified_gap
        if gap is None or self.status not in {Status.OPTIMAL, Status.FEASIBLE}:
            return sentence
        less = "less" if percent(gap) == percent(0.0) else f"{percent(gap)} less"
        saved = f"no plan that could be certified costs {less}"
        if self.status is Status.OPTIMAL:
            return f"plan found, optimal among plans by faces; {saved}"
        return f"{sentence}; {saved}"

    def trajectory(self, name: str) -> Trajectory:
        """Return a vehicle's part of the plan.

        Parameters
        ----------
        name : str
            The vehicle.

        Returns
        -------
        Trajectory
            Its controls, means and covariances.

        Raises
        ------
        KeyError
            If the plan has none of that name.
        """
        for trajectory in self.trajectories:
            if trajectory.name == name:
                return trajectory
        known = ", ".join(repr(t.name) for t in self.trajectories) or "none"
        raise KeyError(f"no vehicle {name!r}; the plan has {known}")

    def __repr__(self) -> str:
        """Return the plan in one line."""
        cost = "no plan" if self.cost is None else f"cost {short_cost(self.cost)}"
        return f"Plan({self.scenario.name!r}, {self.status.value}, {cost}, {self.planner})"

    def _repr_html_(self) -> str:
        """Return its facts, as the file tells them: what notebooks show."""
        facts = [("scenario", self.scenario.name), ("planner", self.planner)]
        facts.append(("status", self.status_sentence))
        if self.cost is None:
            return html_table([*facts, ("why", self.explanation or "not told")])
        facts.append(("cost", short_cost(self.cost)))
        if self.risk.certified is not None:
            certified, bound = bound_texts(self.risk.certified, self.risk.bound)
            facts.append(("risk", f"at most {certified} of {bound}"))
        facts.append(("planned together", listed(["{" + ", ".join(g) + "}" for g in self.sets])))
        return html_table(facts)
