"""Monte Carlo simulation: in what share of samples a plan collides."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from scipy.special import betaincinv

from radmpc.arguments import check_callable, check_integer, check_rng, value_text
from radmpc.errors import ArgumentError
from radmpc.model.given import plan_under
from radmpc.model.plan import Plan
from radmpc.model.scenario import Avoidance
from radmpc.notebook import html_table
from radmpc.records import dataclass
from radmpc.referee.simulation.preparation import prepare
from radmpc.system.processors import num_processors

__all__ = ["Simulation", "check_samples", "simulate"]

_CHUNK_NUMBERS = 100_000
"""Numbers per chunk and step: small enough for the cache, large enough for numpy. Fixed, because a
chunk is what one stream of random numbers fills."""

_LEAST_CHUNK = 512
"""Samples per chunk at least, however many vehicles there are."""

_MOST_SAMPLES = 10**9
"""Samples at most: of more, the list of chunks alone fills the memory."""


@dataclass(frozen=True, slots=True, eq=False)
class Simulation:
    """What happened in many samples.

    Attributes
    ----------
    samples : int
        Samples.
    collisions : int
        Samples with at least one collision, one vehicle outside the workspace, or one range lost.
    pair_collisions, obstacle_collisions, workspace_exits : int
        Samples with at least one of each kind; a sample may count in several.
    saturated : int
        Samples in which some ``|ū + K (x − x̄)|`` exceeds its control limit at some step; what
        exceeds it is cut off.
    overlooked : float
        Upper bound on the probability of everything that was too unlikely to be tested [-].
    range_losses : int
        Samples in which two vehicles lose the range that they keep.

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), rng=0).require()
    >>> seen = radmpc.simulate(plan, 2_000, rng=0)
    >>> seen.samples, seen.rate_low <= seen.rate <= seen.rate_high
    (2000, True)
    """

    samples: int
    collisions: int
    pair_collisions: int
    obstacle_collisions: int
    workspace_exits: int
    saturated: int
    overlooked: float
    range_losses: int = 0

    @property
    def rate(self) -> float:
        """Share of samples that collide."""
        return self.collisions / self.samples

    @property
    def rate_low(self) -> float:
        """Lower end of the two-sided 95 % Clopper-Pearson interval of the probability."""
        if self.collisions == 0:
            return 0.0
        return float(betaincinv(self.collisions, self.samples - self.collisions + 1, 0.025))

    @property
    def rate_high(self) -> float:
        """Upper end of the two-sided 95 % Clopper-Pearson interval of the probability."""
        if self.collisions == self.samples:
            return 1.0
        return float(betaincinv(self.collisions + 1, self.samples - self.collisions, 0.975))

    @property
    def pair_rate(self) -> float:
        """Share of samples in which two vehicles collide."""
        return self.pair_collisions / self.samples

    @property
    def obstacle_rate(self) -> float:
        """Share of samples in which a vehicle hits an obstacle."""
        return self.obstacle_collisions / self.samples

    @property
    def workspace_rate(self) -> float:
        """Share of samples in which a center leaves the workspace."""
        return self.workspace_exits / self.samples

    @property
    def range_rate(self) -> float:
        """Share of samples in which two vehicles lose the range that they keep."""
        return self.range_losses / self.samples

    @property
    def saturation_rate(self) -> float:
        """Share of samples in which a control exceeds its limit."""
        return self.saturated / self.samples

    def _repr_html_(self) -> str:
        """Return rates with their interval: what notebooks show."""
        interval = f"95 %: {self.rate_low:.3g} to {self.rate_high:.3g}"
        lost = [("of them lose a range", f"{self.range_rate:.3g}")] if self.range_losses else []
        return html_table(
            [
                ("samples", f"{self.samples:,}"),
                ("collide", f"{self.rate:.3g} ({interval})"),
                ("of them pairs", f"{self.pair_rate:.3g}"),
                ("of them obstacles", f"{self.obstacle_rate:.3g}"),
                ("of them leave the workspace", f"{self.workspace_rate:.3g}"),
                *lost,
                ("controls saturate", f"{self.saturation_rate:.3g}"),
                ("too unlikely to be tested", f"at most {self.overlooked:.3g}"),
            ]
        )


def check_samples(samples: object) -> int:
    """Return how many samples to fly; refuse none, and more than anybody waits for.

    Parameters
    ----------
    samples : object
        The argument.

    Returns
    -------
    int
        From 1 to 10⁹, Python's.

    Raises
    ------
    ArgumentError
        With what is allowed.
    """
    count = check_integer(samples, "samples", 1)
    if count > _MOST_SAMPLES:
        raise ArgumentError(f"samples must be at most {_MOST_SAMPLES}, got {value_text(count)}")
    return count


def simulate(
    plan: Plan,
    samples: int = 100_000,
    *,
    rng: np.random.Generator | int | None = None,
    progress: Callable[[int, int], None] | None = None,
    avoidance: Avoidance | None = None,
) -> Simulation:
    r"""Fly a plan many times and count collisions.

    Every sample is a whole trajectory, :math:`x^+ = A x + B u + c + w` under the control
    :math:`u = \bar u + K(x - \bar x)`, cut off at the control limit as an autopilot does, with its
    correlation in time; a vehicle with a measurement acts on its estimate of x. What vehicles share
    is drawn once for all of them, and so is, per sample, the factor up to which covariances are
    known, if they are no better known than that. Samples are tested with exact geometry: discs or
    balls of the vehicles' radii against each other and against the obstacles as they are. Under
    ``steps`` at k = 0..T; under ``intervals`` along the path: a double integrator flies the
    parabola of the control it holds over the step, feedback included, everything else the straight
    segment, and the disturbance enters in proportion to time.

    Parameters
    ----------
    plan : Plan
        Judged by its scenario and controls.
    samples : int
        Samples, >= 1.
    rng : Generator, int or None
        Source of randomness or a seed; None draws fresh entropy, where `radmpc.plan` takes seed 0.
        Equal seeds give equal results on any number of cores.
    progress : callable, optional
        Called with samples done and samples in all.
    avoidance : {'intervals', 'steps'} or None
        Where collisions count; None is as in the plan's scenario.

    Returns
    -------
    Simulation
        Counts and rates.

    Raises
    ------
    ArgumentError
        If ``samples`` is not from 1 to 10⁹, the seed below 0, or there is no such avoidance.
    ArgumentTypeError
        If an argument is of another kind.
    NoPlanError
        If the plan holds no trajectories.
    ScenarioError
        If its vehicles or arrays do not fit its scenario, or overflow.

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), rng=0).require()
    >>> radmpc.simulate(plan, 2_000, rng=0).rate <= plan.scenario.risk_bound
    True
    """
    plan = plan_under(plan, avoidance)
    samples = check_samples(samples)
    check_rng(rng)
    check_callable(progress, "progress")
    flight = prepare(plan)
    size = max(_LEAST_CHUNK, _CHUNK_NUMBERS // max(1, flight.sampler.width))
    sizes = [size] * (samples // size) + ([samples % size] if samples % size else [])
    entropy = np.random.default_rng(rng).integers(0, 2**32, size=4).tolist()
    seeds = np.random.SeedSequence(entropy).spawn(len(sizes))
    counts = np.zeros(6, dtype=np.int64)
    done = 0
    pool = ThreadPoolExecutor(max_workers=num_processors())
    try:
        for found, part in zip(pool.map(flight.count, sizes, seeds), sizes, strict=True):
            counts += found
            done += part
            if progress is not None:
                progress(done, samples)
    finally:
        # An interrupted caller waits for the chunks in the air, not for all that are left.
        pool.shutdown(cancel_futures=True)
    total, pairs, obstacles, exits, lost, saturated = (int(c) for c in counts)
    return Simulation(samples, total, pairs, obstacles, exits, saturated, flight.overlooked, lost)
