"""The study's figures: the paper's four, and ours."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from radmpc.arrays import Matrix
from radmpc.experiments.families import paper
from radmpc.experiments.study.design import BASELINE, Study
from radmpc.experiments.study.summary import Quantiles, Summary
from radmpc.geometry import halfspaces
from radmpc.model.plan import Plan
from radmpc.planners.paper.temporal import make_temporal_obstacle
from radmpc.planning import plan
from radmpc.plotting import Chart, Panel, Spread

__all__ = ["curves", "panels"]

_NAMES = {
    "ira": "centralized IRA (branch)",
    "radmpc": "RADMPC approximation",
    BASELINE: "multi-vehicle (the paper)",
}


def curves(summaries: Sequence[Summary], study: Study) -> Mapping[str, Chart]:
    """Return each figure over N, by the name of its file.

    Parameters
    ----------
    summaries : sequence of Summary
        One per method and size.
    study : Study
        Its methods and its risk bound.

    Returns
    -------
    mapping of str to Chart
        Methods without a value are left out of a chart.
    """
    methods = [m.name for m in study.available if m.role != "ablation"]
    main = [m for m in methods if "big-M" not in m]
    bound = study.risk_bound
    chart = partial(_chart, summaries, methods)
    return {
        "runtime": chart(
            methods, lambda s: s.seconds, "Runtime, median and 10–90 %", "seconds", is_log=True
        ),
        "success": chart(
            main,
            lambda s: s.free,
            f"Samples without collision (line: 1 − Δ = {1 - bound:g})",
            "share of samples",
            line=1.0 - bound,
        ),
        "within": chart(
            main, _within, "Plans that collide in at most Δ of the samples", "share of plans"
        ),
        "cost": chart(
            main,
            lambda s: _scaled(s.above_bound, 100.0),
            "Cost above the proven bound, median and 10–90 %",
            "above the bound [%]",
        ),
        "used": chart(
            main,
            lambda s: _scaled(s.used, 100.0),
            "Share of Δ used, by the certificate",
            "certificate / Δ [%]",
            line=100.0,
        ),
        "couplings": chart(
            [name for name in main if name in {BASELINE, "certified"}],
            _missed,
            "Plans with a coupled pair in different sets",
            "share of plans",
        ),
    }


def _chart(
    summaries: Sequence[Summary],
    methods: Sequence[str],
    names: Sequence[str],
    value: Callable[[Summary], Quantiles | None],
    title: str,
    y_label: str,
    *,
    is_log: bool = False,
    line: float | None = None,
) -> Chart:
    """Return one figure; a method looks the same in all of them."""
    spreads = [_spread(summaries, name, value, methods.index(name)) for name in names]
    drawn = [spread for spread in spreads if len(spread.x)]
    return Chart(drawn, title, "vehicles N", y_label, is_log, line)


def _spread(
    summaries: Sequence[Summary],
    method: str,
    value: Callable[[Summary], Quantiles | None],
    look: int,
) -> Spread:
    """Return a method's line."""
    known = [(s, v) for s in summaries if s.method == method and (v := value(s)) is not None]
    return Spread(
        label=_NAMES.get(method, method),
        x=[s.vehicles for s, _ in known],
        low=[v.low for _, v in known],
        middle=[v.median for _, v in known],
        high=[v.high for _, v in known],
        is_bound=[s.is_censored for s, _ in known],
        look=look,
    )


def _scaled(quantiles: Quantiles | None, factor: float) -> Quantiles | None:
    """Return quantiles times a factor."""
    if quantiles is None:
        return None
    return Quantiles(factor * quantiles.low, factor * quantiles.median, factor * quantiles.high)


def _within(summary: Summary) -> Quantiles | None:
    """Return the share of plans that succeed, with its 95 % interval (Wilson)."""
    return _share(summary.successes, summary.plans)


def _missed(summary: Summary) -> Quantiles | None:
    """Return the share of plans with a missed coupling, likewise."""
    return _share(summary.coupled_wrong, summary.plans)


def _share(count: int, total: int) -> Quantiles | None:
    """Return a share with its 95 % interval by Wilson."""
    if total == 0:
        return None
    z = 1.96
    share = count / total
    middle = (share + z * z / (2 * total)) / (1 + z * z / total)
    spread = z * (share * (1 - share) / total + z * z / (4 * total * total)) ** 0.5
    half = spread / (1 + z * z / total)
    return Quantiles(max(0.0, middle - half), share, min(1.0, middle + half))


def panels(study: Study, vehicles: int) -> list[Panel]:
    """Return one problem planned by each main method, the paper's Figure 2 and more.

    Parameters
    ----------
    study : Study
        The study.
    vehicles : int
        Size of the problem; its seed is the study's choice.

    Returns
    -------
    list of Panel
        The approximation with its temporal obstacles.
    """
    scenario = paper(vehicles, study.shown[vehicles])
    found = []
    for method in study.available:
        if method.name not in {"ira", "radmpc", BASELINE, "certified"}:
            continue
        result = plan(scenario, method.planner, rng=study.shown[vehicles], time_limit=study.cap)
        outlines = _temporal(result.record) if method.name == "radmpc" else []
        found.append(Panel(_NAMES.get(method.name, method.name), result.record, outlines))
    return found


def _temporal(record: Plan) -> list[tuple[str, list[Matrix]]]:
    """Return the outlines of every vehicle's temporal obstacle along its plan."""
    scenario = record.scenario
    found = []
    for vehicle, trajectory in zip(scenario.vehicles, record.trajectories, strict=False):
        obstacle = make_temporal_obstacle(
            vehicle,
            trajectory.means,
            trajectory.covariances,
            0,
            intervals=scenario.avoidance == "intervals",
            controls=trajectory.controls,
        )
        pieces = [halfspaces(*obstacle.at(k)).vertices for k in range(scenario.horizon + 1)]
        found.append((vehicle.name, pieces))
    return found
