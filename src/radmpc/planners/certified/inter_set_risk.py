"""Inter-set risk: a quick estimate of which sets collide. It proposes, the referee decides."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.gaussian import Tail, clearance
from radmpc.geometry import sphere_directions
from radmpc.model.scenario import Scenario
from radmpc.nearby import near_pairs_ever

__all__ = ["by_sets", "inter_set_risks", "pair_risks_across_sets"]

_FAR = 8.0
"""Standard deviations beyond which a pair's risk is nothing (6e-16)."""

_NOISELESS = 1e-12
"""Deviations up to which there is no noise: they are rounding of variances that cancel [m]."""

_BLOCK = 100_000
"""Faces of pairs at all steps that are looked at in one go [-]: those of 200 drones in a box at
once took 140 MB."""

_SHARES = (0.5, 0.0, 1.0, 0.25, 0.75)
"""Shares θ of the reserve for the sagitta at the near end that are tried: 4θ² of the sagitta there,
and 4(1 − θ)² at the far end [-]."""


def inter_set_risks(
    scenario: Scenario,
    means: Tensor,
    covariances: Tensor,
    owners: Indices,
    sagittas: Tensor | None = None,
) -> dict[tuple[int, int], float]:
    """Estimate the collision risk of every two sets.

    Parameters
    ----------
    scenario, means, covariances, owners, sagittas
        As in `pair_risks_across_sets`.

    Returns
    -------
    dict
        Risk of the pairs of sets, lower number first, that run any.
    """
    return by_sets(pair_risks_across_sets(scenario, means, covariances, owners, sagittas), owners)


def by_sets(
    pair_risks: Mapping[tuple[int, int], float], owners: Indices
) -> dict[tuple[int, int], float]:
    """Sum the risks of pairs of vehicles over the sets that own them.

    Parameters
    ----------
    pair_risks : mapping of (int, int) to float
        Risks of pairs of vehicles [-].
    owners : (N,) int array
        The set of each vehicle.

    Returns
    -------
    dict of (int, int) to float
        Risks of pairs of sets [-], lower number first.
    """
    found: dict[tuple[int, int], float] = {}
    sets = owners.tolist()
    for (one, two), risk in pair_risks.items():
        i, j = sets[one], sets[two]
        key = (min(i, j), max(i, j))
        found[key] = found.get(key, 0.0) + risk
    return found


def pair_risks_across_sets(
    scenario: Scenario,
    means: Tensor,
    covariances: Tensor,
    owners: Indices,
    sagittas: Tensor | None = None,
    common: Tensor | None = None,
    num_faces: int | None = None,
) -> dict[tuple[int, int], float]:
    """Estimate the collision risk of every two vehicles of different sets.

    By the same faces as the program's, so that what is charged for two sets is what keeping
    them apart in one program would cost, the sagitta between steps included.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    means : (N, T+1, d) array
        Mean positions [m].
    covariances : (N, T+1, d, d) array
        Position covariances [m²].
    owners : (N,) int array
        The set of each vehicle.
    sagittas : (N, T, d) array or None
        ``dt²/8 · ū``: how far each mean curve leaves its chord along each axis, against the
        acceleration [m]; 0 where the path is straight, None where all are.
    common : (N, T+1, d, E) array or None
        What the normals behind shared disturbances make of positions [m]; None is nothing.
    num_faces : int or None
        Faces around a pair; None for the program's.

    Returns
    -------
    dict
        Risk of the pairs of vehicles, lower number first, that run any.
    """
    if np.all(owners == owners[0]):
        return {}
    radii = np.array([v.radius for v in scenario.vehicles])
    longest = 0.0 if sagittas is None else float(np.linalg.norm(sagittas, axis=2).max(initial=0.0))
    # However two are correlated, σ_1 + σ_2 is the most by which they deviate from each other.
    tail = Tail(scenario.covariance_samples)
    noise_factor = np.sqrt(2.0) if common is None else 2.0
    largest = noise_factor * np.sqrt(_largest_variances(covariances))
    one, two = _neighbors(scenario, means, largest, radii, longest)
    apart = owners[one] != owners[two]
    one, two = one[apart], two[apart]
    if one.size == 0:
        return {}
    faces = sphere_directions(num_faces or scenario.num_pair_faces, scenario.dimension)
    noise = np.sum((faces @ covariances) * faces, axis=3)
    step = max(1, _BLOCK // (means.shape[1] * len(faces)))
    risks: list[float] = []
    for begin in range(0, one.size, step):
        pairs = one[begin : begin + step], two[begin : begin + step]
        variances = noise[pairs[0]] + noise[pairs[1]]
        if common is not None:
            variances = variances - 2.0 * _along(faces, common, pairs)
        deviations = np.sqrt(np.maximum(variances, 0.0))
        reach = (radii[pairs[0]] + radii[pairs[1]])[:, None, None]
        apart_by = (means[pairs[0]] - means[pairs[1]]) @ faces.T - reach
        if scenario.avoidance == "intervals":
            sagitta = np.zeros((len(apart_by), apart_by.shape[1] - 1, len(faces)))
            if sagittas is not None:
                sagitta = np.maximum((sagittas[pairs[0]] - sagittas[pairs[1]]) @ faces.T, 0.0)
            by_face = _along_intervals(apart_by, deviations, sagitta, tail)
        else:
            by_face = _tails(apart_by[:, 1:], deviations[:, 1:], tail)
        risks += by_face.min(axis=2).sum(axis=1).tolist()
    return {
        (i, j): risk
        for i, j, risk in zip(one.tolist(), two.tolist(), risks, strict=True)
        if risk > 1e-15
    }


def _along_intervals(apart_by: Tensor, deviations: Tensor, sagitta: Tensor, tail: Tail) -> Tensor:
    """Return the risk of every face along every interval, held at both ends, (p, T, f)."""
    near, far = slice(None, -1), slice(1, None)

    def held(share: float) -> Tensor:
        reserves = 4.0 * share**2 * sagitta, 4.0 * (1.0 - share) ** 2 * sagitta
        at_start = _tails(apart_by[:, near] - reserves[0], deviations[:, near], tail)
        return at_start + _tails(apart_by[:, far] - reserves[1], deviations[:, far], tail)

    return np.asarray(np.minimum.reduce([held(share) for share in _SHARES]))


def _tails(apart_by: Tensor, deviations: Tensor, tail: Tail) -> Tensor:
    """Return tails of slacks; without noise contact alone is a collision."""
    noise = np.where(deviations > _NOISELESS, deviations, 0.0)
    return np.asarray(tail.probability(clearance(apart_by, noise)))


def _along(faces: Matrix, common: Tensor, pairs: tuple[Indices, Indices]) -> Tensor:
    """Return the covariances of pairs along faces that shared disturbances make, (p, T+1, f)."""
    felt = faces @ common
    return np.asarray(np.einsum("ptfe,ptfe->ptf", felt[pairs[0]], felt[pairs[1]]))


def _largest_variances(covariances: Tensor) -> Vector:
    """Return no less than the largest variance in any direction at every step, (T+1,) [m²]."""
    return np.asarray(np.maximum(np.trace(covariances, axis1=2, axis2=3).max(axis=0), 0.0))


def _neighbors(
    scenario: Scenario, means: Tensor, spreads: Vector, radii: np.ndarray, sagitta: float
) -> tuple[Indices, Indices]:
    """Return the pairs of vehicles that come near each other at any step."""
    steps = np.linalg.norm(np.diff(means, axis=1), axis=2).max(initial=0.0)
    path = float(steps) + 2.0 * sagitta if scenario.avoidance == "intervals" else 0.0
    far = Tail(scenario.covariance_samples).beyond(_FAR)
    near = 2.0 * radii.max() + far * spreads + path
    near *= np.sqrt(scenario.dimension)  # a pair's best face may see less than its distance
    one, two = near_pairs_ever(means, near).T
    return one, two
