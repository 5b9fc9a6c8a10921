"""A planning problem: vehicles, obstacles, a workspace and one risk bound."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Literal, TypeVar

from radmpc.arguments import field_integer, field_number, field_parts, field_text, one, value_text
from radmpc.errors import ScenarioError
from radmpc.model import consistency
from radmpc.model.numbers import check_not_negative, check_scenario_numbers
from radmpc.model.obstacle import Obstacle
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.model.workspace import Workspace
from radmpc.notebook import html_table, listed
from radmpc.records import FrozenDict, dataclass, replace
from radmpc.wording import count_text

if TYPE_CHECKING:
    from radmpc.model.relations.keep import Keep

__all__ = ["Avoidance", "Scenario", "Workspace"]

_Part = TypeVar("_Part")

Avoidance = Literal["steps", "intervals"]


@dataclass(frozen=True, slots=True, eq=False)
class Scenario:
    """A fleet, its surroundings and the bound on its joint risk of collision.

    Attributes
    ----------
    name : str
        For titles and files.
    dt : float
        Step [s], > 0.
    horizon : int
        Number of steps T, >= 1.
    risk_bound : float
        Joint bound Δ over all vehicles, obstacles, pairs and times, 0 < Δ < 0.5.
    vehicles : tuple of Vehicle
        At least one, names distinct.
    obstacles : tuple of Obstacle
        Names distinct.
    avoidance : {'intervals', 'steps'}
        Whether collisions count between steps or only at them.
    pair_faces : int or None
        Faces around the relative position of a pair; None is 4 in 2-D and 6 in 3-D.
    workspace : Workspace or None
        None is unbounded.
    source : mapping or None
        Where an imported scenario came from and what was chosen for it; not used in planning. A
        copy that does not change.
    covariance_samples : int or None
        Independent steps ν, >= 3, that all covariances were estimated from: the true ones are
        those stated times one common factor, ``ν / χ²_ν``. None is that they are known.
    time_weight : float
        What a second costs until a vehicle whose goal has a window (``within``) arrives, >= 0
        [cost/s].
    keep : tuple of Keep
        Pairs that stay within a range of each other; losing it counts toward the risk bound.
    goals : tuple of Goal
        Goals that vehicles share, each for one of them: planning assigns them, and those that
        vehicles have are among them. None are shared where it is empty.

    Examples
    --------
    >>> from radmpc import Goal, Obstacle, Scenario, Vehicle, double_integrator
    >>> goal, rock = Goal.at([9.0, 9.0], 0.5), Obstacle.box("rock", [4.0, 3.0], [6.0, 7.0])
    >>> tug = Vehicle("tug", double_integrator(1.0, 2), [1.0, 1.0], goal, radius=0.4,
    ...               control_limit=2.0, initial_covariance=0.001, disturbance_covariance=0.001)
    >>> Scenario("bay", dt=1.0, horizon=10, risk_bound=0.05, vehicles=[tug], obstacles=[rock])
    Scenario('bay', 1 vehicle, 1 obstacle, 10 steps of 1 s, risk bound 0.05)
    """

    name: str
    dt: float
    horizon: int
    risk_bound: float
    vehicles: tuple[Vehicle, ...]
    obstacles: tuple[Obstacle, ...] = ()
    avoidance: Avoidance = "intervals"
    pair_faces: int | None = None
    workspace: Workspace | None = None
    source: Mapping[str, object] | None = None
    covariance_samples: int | None = None
    time_weight: float = 0.0
    keep: tuple[Keep, ...] = ()
    goals: tuple[Goal, ...] = ()

    if TYPE_CHECKING:  # what it takes is wider than what it holds

        def __init__(
            self,
            name: str,
            dt: float,
            horizon: int,
            risk_bound: float,
            vehicles: Iterable[Vehicle],
            obstacles: Iterable[Obstacle] = (),
            avoidance: Avoidance = "intervals",
            pair_faces: int | None = None,
            workspace: Workspace | None = None,
            source: Mapping[str, object] | None = None,
            covariance_samples: int | None = None,
            time_weight: float = 0.0,
            keep: Iterable[Keep] = (),
            goals: Iterable[Goal] = (),
        ) -> None: ...

    def __post_init__(self) -> None:
        """Run every check between the parts."""
        self._check_kinds()
        self._check_numbers()
        if not self.vehicles:
            raise ScenarioError("needs at least one vehicle, got none", ("vehicles",))
        consistency.check_printable(self.name, ("name",))
        consistency.check_distinct([v.name for v in self.vehicles], "vehicles")
        consistency.check_distinct([o.name for o in self.obstacles], "obstacles")
        consistency.check_dimensions(self.vehicles, self.obstacles, self.pair_faces)
        consistency.check_growth(self.vehicles, self.horizon, self.dt)
        consistency.check_workspace(self.vehicles, self.workspace)
        obstacles = tuple(o.laid_out(self.dt, self.horizon) for o in self.obstacles)
        object.__setattr__(self, "obstacles", obstacles)
        consistency.check_moving(self.obstacles, self.horizon)
        consistency.check_step(self.vehicles, self.dt)
        if self.has_shared:
            from radmpc.model.noise.shared import check_sources  # noqa: PLC0415 - few share

            check_sources(vehicle.shared for vehicle in self.vehicles)
        if self.keep or any(obstacle.concerns is not None for obstacle in self.obstacles):
            from radmpc.model.relations.checks import check_relations  # noqa: PLC0415 - few have any

            check_relations(self.keep, self.obstacles, [vehicle.name for vehicle in self.vehicles])
        consistency.check_windows(self.vehicles, self.horizon, self.workspace)
        if self.goals:
            from radmpc.model.relations.goals import check_goals  # noqa: PLC0415 - few share any

            check_goals(self.goals, self.vehicles, self.horizon, self.workspace)

    def __repr__(self) -> str:
        """Return the scenario in one line."""
        return (
            f"Scenario({self.name!r}, {count_text(len(self.vehicles), 'vehicle')}, "
            f"{count_text(len(self.obstacles), 'obstacle')}, {count_text(self.horizon, 'step')} "
            f"of {self.dt:g} s, risk bound {self.risk_bound:g})"
        )

    def _repr_html_(self) -> str:
        """Return its facts: what notebooks show."""
        seconds = self.dt * self.horizon
        facts = [
            ("scenario", self.name),
            ("vehicles", listed([vehicle.name for vehicle in self.vehicles])),
            ("obstacles", listed([obstacle.name for obstacle in self.obstacles])),
            ("time", f"{self.horizon} steps of {self.dt:g} s, {seconds:g} s"),
            ("risk bound", f"{self.risk_bound:g}"),
            (
                "collisions count",
                "along intervals" if self.avoidance == "intervals" else "at steps",
            ),
        ]
        if self.workspace is not None:
            corners = zip(self.workspace.lower, self.workspace.upper, strict=True)
            facts.append(("workspace", " × ".join(f"[{a:g}, {b:g}]" for a, b in corners) + " m"))
        return html_table(facts)

    def _check_kinds(self) -> None:
        """Refuse parts of another kind; make numbers Python's and sequences tuples."""
        put = object.__setattr__
        field_text(self.name, ("name",))
        for name in ("dt", "risk_bound", "time_weight"):
            put(self, name, field_number(getattr(self, name), (name,)))
        put(self, "horizon", field_integer(self.horizon, ("horizon",)))
        for name in ("pair_faces", "covariance_samples"):
            if getattr(self, name) is not None:
                put(self, name, field_integer(getattr(self, name), (name,)))
        put(self, "vehicles", _all_of(Vehicle, self.vehicles, "vehicles"))
        put(self, "obstacles", _all_of(Obstacle, self.obstacles, "obstacles"))
        put(self, "goals", _all_of(Goal, self.goals, "goals"))
        if not isinstance(self.workspace, Workspace | None):
            raise ScenarioError(
                f"must be a Workspace or None, got {value_text(self.workspace)}", ("workspace",)
            )
        if not isinstance(self.keep, tuple) or self.keep:
            from radmpc.model.relations.keep import checked_keep  # noqa: PLC0415 - few keep a range

            put(self, "keep", checked_keep(self.keep))
        if self.source is not None:
            if not isinstance(self.source, Mapping):
                raise ScenarioError(
                    f"must be a mapping or None, got {value_text(self.source)}", ("source",)
                )
            if type(self.source) is not FrozenDict:
                put(self, "source", FrozenDict(self.source))

    def _check_numbers(self) -> None:
        """Check the scalars."""
        check_scenario_numbers(self.dt, self.horizon, self.risk_bound, self.covariance_samples)
        check_not_negative(self.time_weight, "time_weight")
        if not (isinstance(self.avoidance, str) and self.avoidance in {"steps", "intervals"}):
            raise ScenarioError(
                f"must be 'steps' or 'intervals', got {value_text(self.avoidance)}", ("avoidance",)
            )

    @property
    def dimension(self) -> int:
        """Number of coordinates, 2 or 3."""
        return self.vehicles[0].system.dimension

    @property
    def has_shared(self) -> bool:
        """Whether any vehicle has a part in a shared disturbance."""
        return any(vehicle.shared for vehicle in self.vehicles)

    @property
    def num_vehicles(self) -> int:
        """Fleet size N."""
        return len(self.vehicles)

    @property
    def has_windows(self) -> bool:
        """Whether any vehicle visits boxes on its way, or arrives within a window."""
        return any(v.via or v.goal.within is not None for v in self.vehicles)

    @property
    def num_pair_faces(self) -> int:
        """Faces around a pair, the default resolved."""
        return 2 * self.dimension if self.pair_faces is None else self.pair_faces

    def subset(self, indices: Iterable[int], risk_bound: float) -> Scenario:
        """Return the scenario of some of the vehicles alone, with their share of the risk.

        Parameters
        ----------
        indices : iterable of int
            Indices of the vehicles in ``vehicles``.
        risk_bound : float
            Their share of Δ, 0 < share < 0.5.

        Returns
        -------
        Scenario
            The same in everything else.

        Raises
        ------
        ScenarioError
            If an index is out of range.
        """
        parts = field_parts(indices, "a sequence of indices into vehicles", ("indices",))
        places = [field_integer(i, ("indices", k)) for k, i in enumerate(parts)]
        if any(not 0 <= i < len(self.vehicles) for i in places):
            raise ScenarioError(
                f"must be indices from 0 to {len(self.vehicles) - 1}, got {places}", ("indices",)
            )
        chosen = [self.vehicles[i] for i in places]
        return replace(self.with_vehicles(chosen), risk_bound=risk_bound)

    def with_vehicles(
        self, vehicles: Iterable[Vehicle], obstacles: Iterable[Obstacle] | None = None
    ) -> Scenario:
        """Return the scenario of other vehicles, with what those keep and meet that are among them.

        Parameters
        ----------
        vehicles : iterable of Vehicle
            In the place of all.
        obstacles : iterable of Obstacle or None
            In the place of all; None is those of this scenario.

        Returns
        -------
        Scenario
            The same in everything else.

        Raises
        ------
        ScenarioError
            If these vehicles do not fit the rest.
        """
        from radmpc.model.relations.subset import kept_and_met  # noqa: PLC0415 - few take parts

        chosen = tuple(vehicles)
        met = self.obstacles if obstacles is None else obstacles
        keep, some = kept_and_met(chosen, self.keep, met)
        return replace(self, vehicles=chosen, keep=keep, obstacles=some)


def _all_of(kind: type[_Part], given: object, field: str) -> tuple[_Part, ...]:
    """Return parts as a tuple, all of one kind."""
    parts = []
    for i, part in enumerate(field_parts(given, f"a sequence of {kind.__name__}s", (field,))):
        if not isinstance(part, kind):
            raise ScenarioError(f"must be {one(kind)}, got {value_text(part)}", (field, i))
        parts.append(part)
    return tuple(parts)
