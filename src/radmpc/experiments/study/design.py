"""Which methods on which problems: the paper's section Results, and more."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from importlib.util import find_spec

from radmpc.experiments.study.trial import Task
from radmpc.planners import Centralized, Couplings, Ira, Planner, Receding
from radmpc.planners.presets import PRESETS
from radmpc.records import dataclass, field, replace
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.milp.big_m import BigM

__all__ = ["BASELINE", "Method", "Study", "full_study", "quick_study"]

BASELINE = "multi-vehicle"
"""The paper's own method, which ablations are compared with."""

_UNLIMITED = 10_000_000
"""Nodes: the cap alone ends the reference."""


@dataclass(frozen=True, slots=True)
class Method:
    """A method under study.

    Attributes
    ----------
    name : str
        In rows and tables.
    planner : Planner
        Its record.
    seeds : int
        Problems of each size it is tried on.
    sizes : tuple of int or None
        Sizes it is tried on; None is all of the study's.
    budget : float
        Seconds of planning after which no further problem is begun.
    role : {'method', 'reference', 'ablation'}
        References are centralized, ablations read the paper another way.
    package : str or None
        Package without which it cannot run.
    """

    name: str
    planner: Planner
    seeds: int
    sizes: tuple[int, ...] | None = None
    budget: float = float("inf")
    role: str = "method"
    package: str | None = None

    @property
    def is_available(self) -> bool:
        """Whether its package is there."""
        return self.package is None or find_spec(self.package) is not None


@dataclass(frozen=True, slots=True)
class Study:
    """All of it.

    Attributes
    ----------
    sizes : tuple of int
        Fleet sizes N.
    methods : tuple of Method
        What is compared.
    samples : int
        Samples per plan.
    cap : float
        Seconds per problem.
    risk_bound : float
        Δ of the problems.
    shown : mapping
        Seeds of the problems drawn: per fleet size.
    """

    sizes: tuple[int, ...]
    methods: tuple[Method, ...]
    samples: int
    cap: float
    risk_bound: float = 0.05
    shown: Mapping[int, int] = field(default_factory=lambda: {4: 0, 8: 0})

    @property
    def available(self) -> tuple[Method, ...]:
        """The methods that can run here."""
        return tuple(method for method in self.methods if method.is_available)

    def tasks(self) -> tuple[Task, ...]:
        """Return all tasks: seed by seed, so that an early end leaves a balanced sample."""
        most = max(method.seeds for method in self.methods)
        return tuple(
            Task(method.name, method.planner, n, seed, self.samples, self.cap)
            for seed in range(most)
            for n in self.sizes
            for method in self.available
            if seed < method.seeds and n in (method.sizes or self.sizes)
        )

    def recorded(self, names: Collection[str]) -> Study:
        """Return the same study, in which methods that ran elsewhere count as available.

        Parameters
        ----------
        names : collection of str
            Methods with rows; their packages are needed no more.
        """
        methods = (replace(m, package=None) if m.name in names else m for m in self.methods)
        return replace(self, methods=tuple(methods))

    def only(self, names: Sequence[str]) -> Study:
        """Return the same study of some methods."""
        return replace(self, methods=tuple(m for m in self.methods if m.name in names))


def full_study(*, cap: float = 60.0, budget: float = 600.0, seeds: int = 50) -> Study:
    """Return the paper's study, and ours: 50 problems for each N = 2 to 8.

    Parameters
    ----------
    cap : float
        Seconds per problem.
    budget : float
        Seconds for each mixed-integer reference, which cannot do them all.
    seeds : int
        Problems of each size.

    Returns
    -------
    Study
        100,000 samples per plan.
    """
    return Study(
        sizes=tuple(range(2, 9)),
        methods=(*_methods(seeds), *_references(seeds, budget), *_ablations(min(seeds, 20))),
        samples=100_000,
        cap=cap,
    )


def quick_study() -> Study:
    """Return a small sample of everything, for a few minutes."""
    sizes = tuple(range(2, 9))
    references = tuple(
        replace(method, seeds=1, sizes=(2, 3)) for method in _references(1, budget=30.0)
    )
    ablations = tuple(replace(method, sizes=(4, 8)) for method in _ablations(2))
    return Study(sizes, (*_methods(4), *references, *ablations), samples=10_000, cap=10.0)


def _methods(seeds: int) -> tuple[Method, ...]:
    """Return the paper's method, its first stage, its reference, and ours."""
    return (
        Method("ira", Planner(Ira(), Branch(_UNLIMITED), Centralized()), seeds, role="reference"),
        Method("radmpc", PRESETS["radmpc"].planner, seeds),
        Method(BASELINE, PRESETS["multi-vehicle"].planner, seeds),
        Method("certified", PRESETS["certified"].planner, seeds),
    )


def _references(seeds: int, budget: float) -> tuple[Method, ...]:
    """Return centralized IRA by mixed-integer solvers, as the paper has it."""
    return tuple(
        Method(
            f"ira, big-M, {label}",
            Planner(Ira(), BigM(backend), Centralized()),
            seeds,
            budget=budget,
            role="reference",
            package=package,
        )
        for backend, label, package in (("highs", "HiGHS", None), ("scip", "SCIP", "pyscipopt"))
    )


def _ablations(seeds: int) -> tuple[Method, ...]:
    """Return the paper's method with its ambiguous places read the other way."""

    def coupled(receding: Receding, policy: Ira | None = None) -> Planner:
        return Planner(policy or Ira(), Branch(), Couplings(approximation=receding))

    readings = {
        "IRA gives to inactive": coupled(Receding(), Ira(direction="to_inactive")),
        "N* at every step": coupled(Receding(arrivals="every_step")),
        "covariances reset": coupled(Receding(covariances="reset")),
        "obstacles of 3.44 σ": coupled(Receding(sigmas=3.44)),
    }
    return tuple(
        Method(f"{BASELINE}, {name}", planner, seeds, role="ablation")
        for name, planner in readings.items()
    )
