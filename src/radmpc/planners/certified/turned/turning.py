"""Cheaper plans by half-spaces turned to the plan at hand, again and again.

The price is the shadow price of the risk, per unit of probability, unless called a unit price.
"""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Sequence

from radmpc.arrays import Matrix
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.state.timed_judge import estimate
from radmpc.planners.certified.turned.large.groups import groups_of, parts_of
from radmpc.planners.certified.turned.large.side_by_side import share_risk_side_by_side
from radmpc.planners.certified.turned.linear.warm_programs import WarmPrograms
from radmpc.planners.certified.turned.paths import SavedPaths
from radmpc.planners.certified.turned.price_control import PriceControl, SafePaths, Taken
from radmpc.planners.certified.turned.price_tuning import PRICE_TUNING
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.limits.hard import keeps_hard_rows
from radmpc.records import dataclass, field, replace
from radmpc.solvers.solution import Limits

__all__ = ["Turning"]

_LOG = logging.getLogger(__name__)

_NOTHING = 1e-300
"""Stands for a certificate of 0 where one divides by it [-]."""


@dataclass(slots=True, eq=False)
class Turning:
    """How far the turning of a plan has come; it lives for one plan.

    Attributes
    ----------
    task : Task
        What is asked.
    incumbent : FleetIncumbent
        The best plan so far.
    sets : tuple of tuple of int
        Vehicles that are planned together.
    price : float
        Shadow price of the risk, per unit of probability.
    successive : SuccessiveLp
        The latest paths, and what improves them.
    groups : tuple of tuple of int
        Vehicles by linear program: all in a small fleet, else sets side by side.
    risk : float
        What the half-spaces' risks sum to in the last round [-].
    num_solves : int
        Solves of groups so far.
    is_partial : bool
        Whether vehicles are held that pay for risk where they are.
    is_patient : bool
        Whether a share of the time may be taken, whatever work that is.
    enough : float
        Certificate of a plan with which turning ends [-]; inf where it goes on to the best one.
    programs : WarmPrograms or None
        Linear programs to go on with, see `SuccessiveLp`.
    is_above : bool
        Whether it begins with paths that risk too much: the referee is not asked of these.
    is_outside : bool
        Whether it begins with paths beyond the limits of programs; plans keep these limits.
    is_routed : bool
        Whether it begins with routes around obstacles: there a first plan leaves much of Δ.
    latest : float
        Certificate of the latest paths, or about that [-].
    is_cautious : bool
        Whether the last round asked of the nearest points alone, and risks more than before.
    """

    task: Task
    incumbent: FleetIncumbent
    sets: tuple[Members, ...]
    price: float
    successive: SuccessiveLp = field(init=False)
    groups: tuple[Members, ...] = field(init=False)
    risk: float = 0.0
    num_solves: int = 0
    is_partial: bool = False
    is_patient: bool = False
    enough: float = float("inf")
    programs: WarmPrograms | None = None
    is_above: bool = False
    is_outside: bool = False
    is_routed: bool = False
    latest: float = 0.0
    is_cautious: bool = False

    def __post_init__(self) -> None:
        """Choose which vehicles share a linear program."""
        self.groups = groups_of(self.sets, self.task.hazards.count)
        self.successive = SuccessiveLp(self.task.hazards, self.task.limits, self.programs)

    def hold_all_but(self, vehicles: frozenset[int]) -> None:
        """Turn only the sets that hold any of these vehicles.

        Parameters
        ----------
        vehicles : frozenset of int
            Their numbers.
        """
        moving = tuple(members for members in self.sets if vehicles.intersection(members))
        self.groups = groups_of(moving, self.task.hazards.count)

    def run(self, rounds: int, rival: float = float("inf")) -> FleetIncumbent:
        """Turn half-spaces to the latest paths and plan again, until little is gained.

        Parameters
        ----------
        rounds : int
            Turns at most [-].
        rival : float
            Cost of a plan from elsewhere that this is to become cheaper than.

        Returns
        -------
        FleetIncumbent
            The best certified plan so far.
        """
        task, paths = self.task, self.successive.paths
        is_large = task.hazards.count > TUNING.few
        is_urgent = (is_large or self._is_parted) and not self.incumbent.controls
        flags = is_urgent, self.enough < float("inf"), is_large
        control = PriceControl(self.price, task.risk_bound, task.gap, rival, *flags)
        self.successive.programs.forget_all_but(self.groups)
        begun = time.monotonic()
        certified = float("inf") if self.is_above or self.is_outside else self._take()
        control.begin(certified, paths.cost(), paths.state())
        left = task.limits.seconds_left
        # A round without time for its certificate comes to nothing.
        useful = task.limits.within(left - (time.monotonic() - begun))
        patient = task.limits.within(TUNING.patient_share * left)
        waiting = task.limits.within(TUNING.waited_share * left)
        for number in range(rounds):
            some = patient if self.incumbent.controls else waiting
            is_enough = self.incumbent.certified >= self.enough and self.incumbent.controls
            if useful.reached or is_enough or control.is_over or self._has_spent(number, some):
                break
            self.price = control.price
            certified, cost = self._turned_and_taken(number, certified), paths.cost()
            _LOG.info(
                "turn %d of half-spaces: price of 1 %% of the risk bound %.3g, cost %.6g, "
                "certificate %.3g",
                number + 1, 0.01 * task.risk_bound * self.price, cost, certified,
            )  # fmt: skip
            is_still = control.has_nearly_stopped(certified, cost, self.risk)
            between = self._take_between(control.safe, certified) if is_still else None
            back = control.follow(certified, cost, paths.state(), self.risk, between)
            if back is not None:
                self.successive.restore(back)
        return self.incumbent

    def certified(self) -> float:
        """Return the certificate of the latest paths [-]."""
        return self.task.judge(tuple(self.successive.paths.controls)).certified

    @property
    def _is_parted(self) -> bool:
        """Whether a large set between obstacles has no plan yet, and is turned in parts."""
        is_first = self.is_routed and not self.incumbent.controls
        return is_first and max(map(len, self.sets)) > TUNING.most_before_plan

    def _has_spent(self, number: int, some: Limits) -> bool:
        """Whether so many rounds took all the work, or all the time, that turning may take."""
        if not self.incumbent.controls:
            # The next round may lead to a plan, but in a large fleet another beginning may sooner.
            is_many = self.task.hazards.count > TUNING.few
            return is_many and number >= TUNING.waited_rounds and some.reached
        if number < TUNING.least_rounds:
            return False
        if self.is_patient:
            return some.reached
        if self.incumbent.certified < TUNING.unspent * self.task.risk_bound:
            return False  # the price is still too high, and the next round is cheaper
        most_work = max(TUNING.most_work, TUNING.work_each * self.task.hazards.count)
        return self.successive.work >= most_work or self.num_solves >= TUNING.most_solves

    def _turned_and_taken(self, number: int, latest: float) -> float:
        """Turn half-spaces and keep the paths if they are a better plan; return the certificate.

        Given are the round's number, and the certificate before. Without a plan, paths must not get
        stuck between corners; where that risks more, both ends of windows are kept next.
        """
        successive, was_parted = self.successive, self._is_parted
        is_first = self.is_routed and not self.incumbent.controls
        before = (successive.paths.state(), latest) if is_first else None
        successive.asks_nearest = not (self.incumbent.controls or self.is_cautious)
        self._turn(max(TUNING.least_spacing, TUNING.spacing * TUNING.finer**number))
        certified = self._take(before)
        self.is_cautious = successive.asks_nearest and certified > latest
        successive.asks_nearest = False
        if was_parted and not self._is_parted:  # parts are not planned again
            successive.programs.forget_all_but(self.groups)
        return certified

    def _turn(self, spacing: float) -> None:
        """Plan every group once, at once where none shares a set with another."""
        successive, costs, executor = self.successive, (self.price, spacing), self.task.executor
        is_small = max(map(len, self.sets)) <= TUNING.most_together
        if len(self.groups) > 1 and is_small and not self._is_parted:
            self.risk = share_risk_side_by_side(successive, self.groups, costs, executor)
            self.num_solves += len(self.groups)
            return
        self.risk = 0.0
        for group in parts_of(self.groups) if self._is_parted else self.groups:
            if self.task.limits.reached:
                return
            self.risk += successive.share_risk(group, *costs)
            self.num_solves += 1

    def _take_between(self, safe: SafePaths | None, certified: float) -> Taken | None:
        """Keep paths between certified ones and the latest, which risk too much, if they are good.

        Risk is nearly convex in between, so what is linear in it risks hardly more than Δ.
        """
        paths, risk_bound = self.successive.paths, self.task.risk_bound
        if safe is None or certified <= risk_bound or paths.cost() >= self.incumbent.cost:
            return None
        share = (PRICE_TUNING.between * risk_bound - safe.certified) / (certified - safe.certified)
        latest = paths.state()
        paths.mix(safe.paths, 1.0 - share)
        taken = Taken(self._take(), paths.cost())
        paths.restore(latest)
        return taken if taken.certified <= risk_bound else None

    def _take(self, before: tuple[SavedPaths, float] | None = None) -> float:
        """Keep the latest paths if they are certified and the cheapest; return the certificate.

        Before a first plan, paths and certificate of the round before are given, too.
        """
        paths = self.successive.paths
        if self.is_outside and not self._keep_limits(paths.controls):
            return float("inf")
        cost = paths.cost()
        certified = self.latest = self._certificate(tuple(paths.controls), cost)
        is_better = certified <= self.task.risk_bound and cost < self.incumbent.cost
        if is_better and (before is None or not self._keep_nearer(*before, certified)):
            self._keep(certified)
        return certified

    def _keep_nearer(self, before: SavedPaths, risk_before: float, certified: float) -> bool:
        """Keep a first plan that leaves much of Δ nearer to the paths before it, which risk more.

        On the way the logarithm of the risk is nearly linear. Tell whether that was kept.
        """
        paths, risk_bound = self.successive.paths, self.task.risk_bound
        if certified > PRICE_TUNING.unspent * risk_bound or not risk_bound < risk_before < math.inf:
            return False
        least = max(certified, _NOTHING)
        share = math.log(PRICE_TUNING.nearly * risk_bound / least) / math.log(risk_before / least)
        latest, cost = paths.state(), paths.cost()
        paths.mix(before, share)
        mixed = self.task.judge(tuple(paths.controls)).certified
        is_kept = mixed <= risk_bound and paths.cost() < cost
        if is_kept:
            self._keep(mixed)
        paths.restore(latest)
        return is_kept

    def _keep(self, certified: float) -> None:
        """Make the latest paths the plan."""
        ratio = min(self.risk / max(certified, _NOTHING), TUNING.most_ratio)
        # What most vehicles would still pay for risk is what they paid before, and what paths
        # that nobody turned would, too.
        is_known = self.risk > 0.0 and not self.is_partial
        price = self.price * ratio if is_known else self.incumbent.turned_price
        ratio, paths = ratio if is_known else self.incumbent.risk_ratio, self.successive.paths
        self.incumbent = replace(
            self.incumbent,
            controls=tuple(paths.controls),
            cost=paths.cost(),
            certified=certified,
            sets=self.sets,
            turned_price=price,
            risk_ratio=ratio,
        )
        self.task.found(self.incumbent)

    def _certificate(self, controls: tuple[Matrix, ...], cost: float) -> float:
        """Return the certificate of paths, or about that where they cannot become the plan."""
        lost, is_dear = TUNING.lost * self.task.risk_bound, cost >= self.incumbent.cost
        if is_dear or self.latest > lost:
            about = estimate(self.task.judge, controls)
            if about is not None and (is_dear or about > lost):
                return about
        return self.task.judge(controls).certified

    def _keep_limits(self, controls: Sequence[Matrix]) -> bool:
        """Whether controls are those of programs: no vehicle was held where the paths began."""
        both = zip(self.task.hazards.models, controls, strict=True)
        return all(keeps_hard_rows(model, each) for model, each in both)
