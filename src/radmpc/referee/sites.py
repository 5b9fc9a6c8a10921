"""Sites where half-spaces must hold, and their projections on the normals."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.records import dataclass
from radmpc.referee.supports import is_searched, planar_supports

__all__ = ["Chords", "Sites", "chords", "joined", "joined_rows", "over_ends"]


@dataclass(frozen=True, slots=True, eq=False)
class Sites:
    """Places where one half-space must hold, at one step or at all ends of an interval.

    Attributes
    ----------
    means : (S, E, d) array
        Mean (relative) positions [m].
    covariances : (S, E, d, d) array
        Their covariances [m²].
    is_near : tuple of bool
        Which of the E ends stand at the beginning of the interval; one alone is a step.
    sagittas : (S, d) array
        Deviation of the mean curve from its chord in the middle of the interval, 0 at steps [m].
    radii : (S,) array
        Radius that grows the set [m].
    vertices : (S, 1 or 2, V, d) array
        Corners of the set, at both steps around where it moves; the origin for pairs [m].
    blends : (S, E) array
        How far between those steps each end is, 0 to 1.
    edges : (S, 1 or 2, R, 2, d) array
        Ends of the set's edges in space; R = 0 in the plane and for pairs [m].
    samples : int or None
        Independent steps that covariances were estimated from; None is that they are known.
    """

    means: Tensor
    covariances: Tensor
    is_near: tuple[bool, ...]
    sagittas: Matrix
    radii: Vector
    vertices: Tensor
    blends: Matrix
    edges: Tensor
    samples: int | None = None

    def take(self, chosen: Indices) -> Sites:
        """Return some of the sites."""
        return Sites(
            self.means[chosen],
            self.covariances[chosen],
            self.is_near,
            self.sagittas[chosen],
            self.radii[chosen],
            self.vertices[chosen],
            self.blends[chosen],
            self.edges[chosen],
            self.samples,
        )


def joined(every: Sequence[Sites]) -> Sites:
    """Return sites one after the other, all with as many corners as the one with most.

    Parameters
    ----------
    every : sequence of Sites
        In the plane, with equal ends each.
    """
    first = every[0]
    return Sites(
        np.concatenate([sites.means for sites in every]),
        np.concatenate([sites.covariances for sites in every]),
        first.is_near,
        np.concatenate([sites.sagittas for sites in every]),
        np.concatenate([sites.radii for sites in every]),
        joined_rows([sites.vertices[:, 0] for sites in every])[:, None],
        np.concatenate([sites.blends for sites in every]),
        np.concatenate([sites.edges for sites in every]),
        first.samples,
    )


def joined_rows(every: Sequence[Tensor], axis: int = 1) -> Tensor:
    """Return rows of vectors one after the other, the first of each repeated where there are fewer.

    Parameters
    ----------
    every : sequence of (S, ..., V, d) array
        V is at least 1 in each.
    axis : int
        That of V.
    """
    most = max(rows.shape[axis] for rows in every)
    padded = []
    for rows in every:
        first = rows.take([0], axis)
        missing = most - rows.shape[axis]
        padded.append(np.concatenate([rows, np.repeat(first, missing, axis)], axis))
    return np.concatenate(padded)


@dataclass(frozen=True, slots=True, eq=False)
class Chords:
    """Sites as seen along directions; in memory ends come first, so that rows are long.

    Attributes
    ----------
    margins : (S, C, E) array
        Those of `end_margins` without any reserve [m].
    deviations : (S, C, E) array
        Standard deviations [m].
    sagittas : (S, C) array
        Deviation of the mean curves from their chords toward the sets in mid-interval [m].
    """

    margins: Tensor
    deviations: Tensor
    sagittas: Matrix


def chords(sites: Sites, directions: Tensor) -> Chords:
    """Return what `end_margins` and `clearances` are made of.

    One product with everything there is, and sums over the first axis of it: arrays are small,
    and most of the time goes into calls and short inner loops.

    Parameters
    ----------
    sites : Sites
        S sites with E ends.
    directions : (S, C, d) array
        Unit normals [-].
    """
    count, ends, d = sites.means.shape
    supports = _searched_supports(sites.vertices, directions)
    compared = sites.vertices if supports is None else sites.vertices[:, :0]
    num_sets, corners = compared.shape[1:3]
    parts = [sites.means, compared, sites.sagittas, sites.covariances]
    columns = np.concatenate([part.reshape(count, -1, d) for part in parts], axis=1)
    turned = directions.transpose(2, 0, 1)
    products = np.empty((columns.shape[1], *turned.shape[1:]))
    np.matmul(columns, turned.transpose(1, 0, 2), out=products.transpose(1, 0, 2))
    along, products = products[:ends], products[ends:]
    if supports is None:
        supports = [products[k * corners : (k + 1) * corners].max(axis=0) for k in range(num_sets)]
    support = supports[0][None]
    if len(supports) == 2:
        blend = sites.blends.T[:, :, None]
        # The support of a Minkowski interpolation is that of the supports.
        support = (1.0 - blend) * supports[0] + blend * supports[1]
    margins = along - support - sites.radii[:, None]
    sagittas = np.maximum(products[num_sets * corners], 0.0)
    spread = products[num_sets * corners + 1 :].reshape(ends, d, *sagittas.shape)
    variance = reduce(np.add, [spread[:, axis] * turned[axis] for axis in range(d)])
    deviations = np.sqrt(np.maximum(variance, 0.0))
    return Chords(margins.transpose(1, 2, 0), deviations.transpose(1, 2, 0), sagittas)


def _searched_supports(vertices: Tensor, directions: Tensor) -> list[Matrix] | None:
    """Return the supports of each set along directions; None where all corners are compared."""
    if not is_searched(vertices.shape[2], *directions.shape[1:]):
        return None
    found = [planar_supports(vertices[:, k], directions) for k in range(vertices.shape[1])]
    known = [each for each in found if each is not None]
    return known if len(known) == len(found) else None


def over_ends(risks: Tensor) -> Tensor:
    """Return sums over the last axis, (…); by columns, which is faster where there are few."""
    return np.asarray(reduce(np.add, [risks[..., end] for end in range(risks.shape[-1])]))
