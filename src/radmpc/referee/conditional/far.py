r"""What was so far away when a leg was bought that no rows of it were written down.

An encounter whose balls do not meet is charged unseen, as in the certificate. Its event is the
union of the rows that would have been bought, fixed sets: their conditional probability is a
martingale that begins at no more than the charge. A price counts the charge, a tail counts nothing
from below, and neither makes wealth. From above a tail counts what half-spaces across the lines of
centers leave now, as long as smaller balls around what is measured do not meet; where they do, the
rows are written down after all, and valued.
"""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Tensor
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass
from radmpc.referee.conditional.loops import Loops, Since
from radmpc.referee.conditional.scales import Scale
from radmpc.referee.encounters import Encounters
from radmpc.referee.gather import Gathered, near_pieces
from radmpc.referee.motion import FleetMotion
from radmpc.referee.neighbors import Balls, near_pairs
from radmpc.referee.tails import cutoff_of, exceeding

__all__ = ["Far", "closer_of", "far_of", "is_surprised"]

_CLOSER, _CUTOFF = 7.5, 9.0
"""Distance from which an encounter stays far under way [standard deviations]. A mean may move by
5 deviations until balls of this size leave those of 9 that were looked at when the leg was bought:
``7.5² + 5² ≈ 9²``."""


@dataclass(frozen=True, slots=True, eq=False)
class Far:
    """Encounters without rows.

    Attributes
    ----------
    count : int
        How many there are.
    pairs : (P,) int array
        Pairs that have rows, the first vehicle times N plus the second; ascending.
    pieces : (Q, 3) int array
        Vehicles, obstacles and pieces that have rows.
    """

    count: int
    pairs: Indices
    pieces: Indices

    def leaves_out(self, batch: Encounters, num_vehicles: int) -> Indices:
        """Return which encounters of a batch have no rows.

        Parameters
        ----------
        batch : Encounters
            Pairs, or vehicles and pieces of obstacles.
        num_vehicles : int
            N.
        """
        if batch.is_pair:
            return np.flatnonzero(~np.isin(batch.first * num_vehicles + batch.other, self.pairs))
        has_rows = set(map(tuple, self.pieces.tolist()))
        keys = zip(batch.first.tolist(), batch.other.tolist(), batch.piece.tolist(), strict=True)
        return np.flatnonzero([key not in has_rows for key in keys])

    def charge(self, windows: int, each: float, *, intervals: bool) -> float:
        """Return what they are charged for some windows.

        Parameters
        ----------
        windows : int
            Steps or intervals.
        each : float
            Risk of one half-space where balls do not meet [-].
        intervals : bool
            Which of both.
        """
        return self.count * (3 * windows if intervals else windows) * each


def closer_of(samples: int | None) -> tuple[float, float]:
    """Return from what distance an encounter is far under way, and the risk of a half-space there.

    Parameters
    ----------
    samples : int or None
        Degrees of freedom of tails; None is that covariances are known.

    Returns
    -------
    tuple of float
        In standard deviations, and a probability.
    """
    distance = _CLOSER / _CUTOFF * cutoff_of(samples)[0]
    return distance, float(exceeding(np.array(distance), samples))


def far_of(scenario: Scenario, obstacles: Gathered, pairs: Gathered) -> Far:
    """Return which encounters were left out when a leg was gathered.

    Parameters
    ----------
    scenario : Scenario
        The leg's.
    obstacles, pairs : Gathered
        What has rows.
    """
    count = int(obstacles.skipped.sum() + pairs.skipped.sum())
    none = np.zeros((0, 3), dtype=np.int64)
    pieces = [np.column_stack([b.first, b.other, b.piece]) for b in obstacles.batches]
    keys = [b.first * scenario.num_vehicles + b.other for b in pairs.batches]
    return Far(count, np.concatenate([none[:, 0], *keys]), np.concatenate([none, *pieces]))


def is_surprised(
    far: Far,
    scenario: Scenario,
    motion: FleetMotion,
    known: tuple[Loops, Since, Scale],
    deviations: Tensor,
) -> bool:
    """Whether anything without rows may come near, given what was measured.

    Parameters
    ----------
    far : Far
        What has no rows.
    scenario : Scenario
        The leg's.
    motion : FleetMotion
        Its nominal.
    known : tuple of Loops, Since and Scale
        Its loops, what noise adds from the measurement on, and the factor of that.
    deviations : (S, N, n) array
        Measured deviations from the nominal.
    """
    if not far.count:
        return False
    intervals = scenario.avoidance == "intervals"
    step = known[1].step
    reaches = None
    if motion.tracks is not None:
        # Their places are not measured; deviations of two add up to less than their sum.
        strays = np.vstack([motion.tracks.deviations, np.zeros(scenario.horizon + 1)])
        reaches = strays[motion.tracks.places]
    loops, noise, scale = known
    closer = closer_of(scale.samples)[0]
    distances = closer * np.sqrt(np.broadcast_to(scale.factor, len(deviations)))
    for sample, distance in zip(deviations, distances.tolist(), strict=True):
        balls = _balls(motion, (loops, noise, distance), sample, intervals=intervals)
        found = near_pairs(balls)
        if not np.isin(found[:, 0] * len(sample) + found[:, 1], far.pairs).all():
            return True
        pieces = set(map(tuple, far.pieces.tolist()))
        strayed = None if reaches is None else distance * reaches
        for near in near_pieces(scenario, balls, step, strayed, intervals=intervals):
            for vehicle in near.vehicles.tolist():
                if (vehicle, near.obstacle, near.piece) not in pieces:
                    return True
    return False


def _balls(
    motion: FleetMotion, known: tuple[Loops, Since, float], sample: Tensor, *, intervals: bool
) -> Balls:
    """Return where each vehicle is in each window to come, given one measurement."""
    loops, noise, distance = known
    step = noise.step
    moved = np.einsum("ndi,knij,nj->nkd", loops.picks, noise.powers, sample)
    positions = motion.positions[:, step:] + moved
    spreads = np.einsum("ndi,knij,nej->nkde", loops.picks, noise.covariances, loops.picks)
    sizes = np.sqrt(np.linalg.eigvalsh(spreads)[..., -1].clip(min=0.0))
    radii = motion.radii[:, None]
    if not intervals or step == motion.positions.shape[1] - 1:
        return Balls(positions, radii + distance * sizes)
    # Feedback held over a step moves the near end; see `motion_balls`.
    bent = loops.picks - loops.bends
    bends = np.einsum("ndi,knij,nej->nkde", bent, noise.covariances[:-1], bent)
    bent_sizes = np.sqrt(np.linalg.eigvalsh(bends)[..., -1].clip(min=0.0))
    sizes = np.maximum(np.maximum(sizes[:, :-1], sizes[:, 1:]), bent_sizes)
    pulled = np.einsum("ndi,knij,nj->nkd", loops.bends, noise.powers[:-1], sample)
    before, after = positions[:, :-1], positions[:, 1:]
    reaches = 0.5 * np.linalg.norm(after - before, axis=2) + distance * sizes + radii
    reaches += np.linalg.norm(motion.sagittas[:, step:], axis=2) + np.linalg.norm(pulled, axis=2)
    return Balls(0.5 * (before + after), reaches)
