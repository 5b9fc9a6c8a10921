"""What is in ``compiled/``: a dual simplex method, rating, chance rows, and lattice searches."""

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.solvers.lp.outcome import Numbers

Single = npt.NDArray[np.float32]
Bits = npt.NDArray[np.uint8]
Shape = tuple[int, int, int]
Box = tuple[int, int, int, int]

class Program:
    def __new__(
        cls, cost: Vector, lower: Vector, upper: Vector, tolerance: float, /
    ) -> Program: ...
    @property
    def pivots(self) -> int: ...
    @property
    def num_rows(self) -> int: ...
    @property
    def num_columns(self) -> int: ...
    def add_rows(
        self, starts: Numbers, columns: Numbers, values: Matrix, lower: Vector, upper: Vector, /
    ) -> None: ...
    def add_column(self, cost: float, upper: float, rows: Numbers, values: Vector, /) -> None: ...
    def bound_rows(self, rows: Numbers, lower: Vector, upper: Vector, /) -> None: ...
    def change_cost(self, cost: Vector, /) -> None: ...
    def solve(self, cutoff: float, most_pivots: int, /) -> tuple[int, float]: ...
    def point(self, into: Vector, /) -> None: ...
    def basis(self) -> bytes: ...
    def begin_with(self, basis: bytes, /) -> None: ...
    def contents(self) -> tuple[bytes, ...]: ...

class Ratings:
    def __new__(
        cls,
        output_starts: Numbers,
        output_columns: Numbers,
        output_values: Vector,
        row_starts: Numbers,
        row_outputs: Numbers,
        row_values: Vector,
        constant: Vector,
        offsets: Vector,
        deviations: Vector,
        table: Numbers,
        alternative_starts: Numbers,
        alternative_rows: Numbers,
        events: Numbers,
        num_columns: int,
        width: int,
        num_events: int,
        samples: int,
        reference: float,
        /,
    ) -> Ratings: ...
    def rate(
        self,
        num_columns: int,
        point: Vector,
        clearances: Vector,
        cheapest: Vector,
        selection: Indices,
        short: Matrix,
        /,
    ) -> tuple[float, float]: ...

class RiskRows:
    def __new__(
        cls,
        program: Program,
        ratings: Ratings,
        deviations: Vector,
        blocks: Numbers,
        bound_rows: Numbers,
        has_block: npt.NDArray[np.bool_],
        first_clearances: Vector,
        first_slopes: Vector,
        first_heights: Vector,
        budget_row: int,
        unit: float,
        price: float,
        row_scale: float,
        row_cap: float,
        floor: float,
        flat: float,
        /,
    ) -> RiskRows: ...
    def activate(self, alternatives: tuple[int, ...], crowd: int, crowd_each: int, /) -> bool: ...
    def refine(self, clearances: Vector, point: Vector, tolerance: float, /) -> bool: ...

class Nodes:
    def __new__(
        cls,
        rows: RiskRows,
        ratings: Ratings,
        owners: Numbers,
        is_refined: npt.NDArray[np.bool_],
        weights: Vector,
        factors: Vector,
        best_point: Vector,
        best_selection: Indices,
        short: Matrix,
        precision: tuple[float, float, float, float, float],
        risks: tuple[float, float, float],
        counts: tuple[int, int, int, int, int],
        /,
    ) -> Nodes: ...
    def solve(
        self, chosen: tuple[int, ...], basis: bytes, bound: float, value: float, has_plan: bool, /
    ) -> tuple[int, float, int, int, int, bytes, bool, float, float]: ...

def choose_avoidance(
    short: Matrix,
    cheapest: Vector,
    is_decided: npt.NDArray[np.bool_],
    weights: Vector,
    factors: Vector,
    by_weight: bool,
    /,
) -> tuple[int, bool]: ...
def lattice_slacks(
    shape: Shape,
    here: Matrix,
    ahead: Matrix,
    x: Vector,
    y: Vector,
    x_ahead: Vector,
    y_ahead: Vector,
    longest: tuple[float, float],
    bounds: tuple[float, float],
    /,
) -> tuple[bytes, bytes, bytes]: ...
def lattice_add_tails(
    risks: Single,
    numbers: npt.NDArray[np.uint32],
    slacks: Single,
    tails: Single,
    scale: float,
    /,
) -> None: ...
def lattice_change(
    shape: Shape,
    infeasible: float,
    box: Box,
    values: Single,
    table: Single,
    axis: int,
    into: Single,
    /,
) -> None: ...
def lattice_move(
    shape: Shape,
    infeasible: float,
    source: Box,
    target: Box,
    values: Single,
    risks: Single,
    blocked: Bits,
    costs: tuple[float, float, float],
    in_time: Box,
    into: Single,
    /,
) -> None: ...
def passing_costs(
    places: Matrix,
    path: Matrix,
    moves: int,
    terms: tuple[float, float, float],
    is_along: bool,
    /,
) -> tuple[bytes, bytes, bytes]: ...
