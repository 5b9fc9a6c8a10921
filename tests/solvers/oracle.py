"""A third opinion on fixed-risk optima that shares nothing with the program or its solvers.

States stay variables, tied by the dynamics; faces come straight from the scenario; sides are
enumerated one avoidance after the other, cut off by scipy's own interface to linear programming.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import numpy as np
from scipy.optimize import linprog
from scipy.stats import norm

from radmpc.model.scenario import Scenario

Directions = Mapping[tuple[str, str], Sequence[np.ndarray]]


def least_cost(
    scenario: Scenario, risk: float, *, is_curved: bool = True, more: Directions | None = None
) -> float:
    """Return the least cost with every face held back for the same risk; inf if infeasible.

    Under intervals with the whole sagitta in reserve at both ends, or (not curved) with none.
    ``more`` are unit normals that count as faces, too, by the names of who avoids whom.
    """
    model = _Model(scenario, norm.isf(risk), is_curved, more or {})
    return model.search([], np.inf)


class _Model:
    def __init__(
        self, scenario: Scenario, sigmas: float, is_curved: bool, more: Directions
    ) -> None:
        self.is_curved = is_curved
        self.more = more
        self.scenario = scenario
        self.sigmas = sigmas
        self.T = scenario.horizon
        self.width = 4 * (self.T + 1) + 4 * self.T  # states, controls, absolute controls
        n = self.width * scenario.num_vehicles
        self.cost = np.zeros(n)
        self.bounds: list[tuple[float | None, float | None]] = [(None, None)] * n
        self.equal: list[tuple[np.ndarray, float]] = []
        self.below: list[tuple[np.ndarray, float]] = []
        self.covariances = []
        for i in range(scenario.num_vehicles):
            self._vehicle(i)
        self.avoidances = self._avoidances()

    def x(self, i: int, k: int, a: int) -> int:
        return self.width * i + 4 * k + a

    def u(self, i: int, k: int, a: int) -> int:
        return self.width * i + 4 * (self.T + 1) + 2 * k + a

    def size(self, i: int, k: int, a: int) -> int:
        return self.width * i + 4 * (self.T + 1) + 2 * self.T + 2 * k + a

    def row(self, entries: dict[int, float]) -> np.ndarray:
        row = np.zeros(self.cost.size)
        for column, value in entries.items():
            row[column] += value
        return row

    def _vehicle(self, i: int) -> None:
        v, T, dt = self.scenario.vehicles[i], self.T, self.scenario.dt
        for a in range(4):
            self.equal.append((self.row({self.x(i, 0, a): 1.0}), float(v.start[a])))
        for k, a in itertools.product(range(T), range(2)):
            p, s, u = self.x(i, k, a), self.x(i, k, a + 2), self.u(i, k, a)
            step = {self.x(i, k + 1, a): 1.0, p: -1.0, s: -dt, u: -0.5 * dt**2}
            self.equal.append((self.row(step), 0.0))
            self.equal.append((self.row({self.x(i, k + 1, a + 2): 1.0, s: -1.0, u: -dt}), 0.0))
            limit = float(v.control_limit[a])
            self.bounds[u] = (-limit, limit)
            self.cost[self.size(i, k, a)] = v.cost_weight
            for sign in (1.0, -1.0):
                self.below.append((self.row({u: sign, self.size(i, k, a): -1.0}), 0.0))
            if v.speed_limit is not None:
                top = float(v.speed_limit[a])
                self.bounds[self.x(i, k + 1, a + 2)] = (-top, top)
        for a in range(2):
            self.bounds[self.x(i, T, a)] = (float(v.goal.lower[a]), float(v.goal.upper[a]))
            top = float(v.goal.speed[a])
            self.bounds[self.x(i, T, a + 2)] = (-top, top)
        sigma = [v.initial_covariance]
        for _ in range(T):
            sigma.append(v.system.A @ sigma[-1] @ v.system.A.T + v.disturbance_covariance)
        self.covariances.append(np.array(sigma)[:, :2, :2])

    def _avoidances(self) -> list[list[list[tuple[np.ndarray, float]]]]:
        s = self.scenario
        found = []
        windows = range(1, self.T + 1) if s.avoidance == "steps" else range(self.T)
        for w in windows:
            for i, o in itertools.product(range(s.num_vehicles), s.obstacles):
                for piece in o.at(w):
                    faces = list(zip(piece.normals, piece.offsets, strict=True))
                    extra = self.more.get((s.vehicles[i].name, o.name), ())
                    faces += [(n, float((piece.vertices @ n).max())) for n in extra]
                    found.append(
                        [self._hold(w, {i: 1.0}, n, g + s.vehicles[i].radius) for n, g in faces]
                    )
            for i, j in itertools.combinations(range(s.num_vehicles), 2):
                apart = s.vehicles[i].radius + s.vehicles[j].radius
                extra = self.more.get((s.vehicles[i].name, s.vehicles[j].name), ())
                axes = ((1, 0), (0, 1), (-1, 0), (0, -1), *extra)
                found.append(
                    [self._hold(w, {i: 1.0, j: -1.0}, np.array(n, float), apart) for n in axes]
                )
        return found

    def _hold(
        self, window: int, signs: dict[int, float], n: np.ndarray, g: float
    ) -> list[tuple[np.ndarray, float]]:
        """Rows of n·x >= g at the window's ends, the sagitta of the mean curve included."""
        intervals = self.scenario.avoidance == "intervals"
        rows = []
        for k in (window, window + 1) if intervals else (window,):
            deviation = np.sqrt(sum(n @ self.covariances[i][k] @ n for i in signs))
            entries: dict[int, float] = {}
            for i, sign in signs.items():
                for a in range(2):
                    entries[self.x(i, k, a)] = -sign * n[a]
            right = -(g + self.sigmas * deviation)
            rows.append((self.row(entries), right))
            if intervals and self.is_curved:
                rows += [
                    (self.row(entries) + self.row(sagitta), right)
                    for sagitta in self._sagittas(window, signs, n)
                ]
        return rows

    def _sagittas(self, k: int, signs: dict[int, float], n: np.ndarray) -> list[dict[int, float]]:
        """max(0, n·a) dt²/8 per vehicle and axis, as all combinations of which are counted."""
        terms = [(self.u(i, k, a), sign * n[a]) for i, sign in signs.items() for a in range(2)]
        terms = [(column, value) for column, value in terms if value != 0.0]
        factor = self.scenario.dt**2 / 8.0
        return [
            {
                column: factor * value
                for (column, value), on in zip(terms, chosen, strict=True)
                if on
            }
            for chosen in itertools.product((False, True), repeat=len(terms))
        ]

    def solve(self, chosen: list[tuple[np.ndarray, float]]) -> tuple[float, np.ndarray | None]:
        below = self.below + chosen
        answer = linprog(
            self.cost,
            A_ub=np.array([r for r, _ in below]),
            b_ub=np.array([b for _, b in below]),
            A_eq=np.array([r for r, _ in self.equal]),
            b_eq=np.array([b for _, b in self.equal]),
            bounds=self.bounds,
            method="highs-ds",
        )
        return (np.inf, None) if answer.x is None else (float(answer.fun), answer.x)

    def search(self, chosen: list[tuple[np.ndarray, float]], best: float) -> float:
        cost, x = self.solve(chosen)
        if x is None or cost >= best - 1e-9:
            return best
        for avoidance in self.avoidances:
            if not any(all(r @ x <= b + 1e-7 for r, b in rows) for rows in avoidance):
                for rows in avoidance:
                    best = self.search(chosen + rows, best)
                return best
        return cost
