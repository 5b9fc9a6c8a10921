"""The study's report: Markdown with tables, figures beside it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from radmpc.experiments.study.design import BASELINE, Study
from radmpc.experiments.study.pictures import curves, panels
from radmpc.experiments.study.summary import Quantiles, Speedup, Summary, speedup, summarize
from radmpc.experiments.study.trial import Row
from radmpc.plotting import save_chart, save_panels
from radmpc.system.atomic import write_text

__all__ = ["write_report"]

_MOST_LISTED = 40
"""Plans above the bound that the report lists; the rest is counted."""


def write_report(
    study: Study,
    rows: Sequence[Row],
    folder: Path,
    *,
    progress: Callable[[str], None] | None = None,
) -> tuple[Path, ...]:
    """Write tables and figures of a study, as far as it has come.

    Parameters
    ----------
    study : Study
        What was to be done.
    rows : sequence of Row
        What was done, here or elsewhere; rows of other studies are left out.
    folder : Path
        Folder to write to.
    progress : callable or None
        Called with each file before it is written.

    Returns
    -------
    tuple of Path
        What was written, the report first.
    """
    tell = progress or (lambda name: None)
    study = study.recorded({row.method for row in rows})
    keys = {task.key for task in study.tasks()}
    known = list({row.key: row for row in rows if row.key in keys}.values())
    summaries = summarize(known, study.risk_bound)
    written = [folder / "report.md"]
    tell("report.md")
    write_text(written[0], report_text(study, known, summaries))
    for name, chart in curves(summaries, study).items():
        written.append(folder / f"{name}.png")
        tell(written[-1].name)
        save_chart(chart, written[-1])
    for vehicles in study.shown:
        written.append(folder / f"plans-{vehicles}.png")
        tell(written[-1].name)
        save_panels(panels(study, vehicles), written[-1])
    return tuple(written)


def report_text(study: Study, rows: Sequence[Row], summaries: Sequence[Summary]) -> str:
    """Return the report in Markdown.

    Parameters
    ----------
    study : Study
        What was to be done.
    rows : sequence of Row
        What was done.
    summaries : sequence of Summary
        The same by method and size.

    Returns
    -------
    str
        The whole file.
    """
    named = {method.name for method in study.methods if method.role != "ablation"}
    main = [summary for summary in summaries if summary.method in named]
    parts = [
        "# The paper's experiments, done again",
        _introduction(study, rows),
        *_origin(rows),
        "## Runtime",
        _seconds_table(study, summaries),
        "![Runtime](runtime.png)",
        "## Speed-up",
        f"How many times as long centralized IRA takes as `{BASELINE}` and as `certified`, on the "
        "same problems.",
        _speedup_table(study, rows),
        "## Success",
        "A success is a plan whose simulated collision rate is at most Δ, as the paper counts; "
        "*surely above Δ* are plans for which even the lower end of the rate's 95 % interval is. "
        "A plan that uses all of Δ comes out on either side by chance. "
        "*Samples free* is the share of samples without a collision: median and 10th percentile "
        "over the problems.",
        _success_table(main),
        "![Success](success.png)",
        "![Within](within.png)",
        "### Plans that collide more often than Δ",
        _failures([row for row in rows if row.method in named], study.risk_bound),
        "## Cost, risk and couplings",
        "Cost above the lower bound proven for the same problem, share of Δ that the certificate "
        "uses, plans certified above Δ, and plans with a pair of different sets above the coupling "
        "threshold Ψ.",
        _quality_table(main),
        "![Cost](cost.png)",
        "![Used](used.png)",
        "![Couplings](couplings.png)",
        *_ablations(study, rows),
        "## Plans",
        *[f"![Plans of {n} vehicles](plans-{n}.png)" for n in study.shown],
    ]
    return "\n\n".join(parts) + "\n"


def _introduction(study: Study, rows: Sequence[Row]) -> str:
    """Return how far the study has come, and how capped runs count."""
    return (
        f"{len(rows)} of {len(study.tasks())} runs: fleets of {study.sizes[0]} to "
        f"{study.sizes[-1]} vehicles, Δ = {study.risk_bound:g}, {study.samples:,} samples per "
        f"plan, at most {study.cap:g} s per problem. A run that the cap ended counts at the cap; "
        "medians and ratios that rest on such runs are lower bounds, marked with >."
    )


def _origin(rows: Sequence[Row]) -> list[str]:
    """Return what the rows were made with and on."""
    versions = sorted({f"{k} {v}" for row in rows for k, v in row.versions.items()})
    machines = sorted({", ".join(f"{k} {v}" for k, v in row.machine.items()) for row in rows})
    return [f"Made with {', '.join(versions)}; on: {'; '.join(machines)}."] if rows else []


def _table(head: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Return a Markdown table."""
    rule = "|" + "---|" * len(head)
    return "\n".join([_line(head), rule, *map(_line, lines)])


def _line(cells: Sequence[str]) -> str:
    """Return one line of a table."""
    return "| " + " | ".join(cells) + " |"


def _seconds_table(study: Study, summaries: Sequence[Summary]) -> str:
    """Return median seconds, and the 90th percentile, per method and size."""
    cells = {(s.method, s.vehicles): _seconds_cell(s) for s in summaries}
    names = [m.name for m in study.available if m.role != "ablation"]
    lines = [[f"`{n}`", *(cells.get((n, size), "–") for size in study.sizes)] for n in names]
    return _table(["seconds, median (90 %)", *(f"N = {n}" for n in study.sizes)], lines)


def _seconds_cell(summary: Summary) -> str:
    """Return one cell: seconds, how many runs, how many of them capped."""
    if summary.seconds is None:
        return "–"
    mark = ">" if summary.is_censored else ""
    text = f"{mark}{_short(summary.seconds.median)} ({_short(summary.seconds.high)})"
    if summary.capped:
        text += f", {summary.capped} of {summary.problems} capped"
    return text


def _speedup_table(study: Study, rows: Sequence[Row]) -> str:
    """Return ratios of seconds per reference and size."""
    lines = []
    for reference in (m.name for m in study.available if m.role == "reference"):
        for n in study.sizes:
            found = [speedup(rows, reference, method, n) for method in (BASELINE, "certified")]
            if found[0] is not None or found[1] is not None:
                counts = next(f for f in found if f is not None)
                lines.append(
                    [f"`{reference}`", str(n), f"{counts.problems} ({counts.capped} capped)"]
                    + [_ratio(f) for f in found]
                )
    head = ["reference", "N", "problems", f"over `{BASELINE}`: mean, geometric (range)"]
    return _table([*head, "over `certified`"], lines)


def _ratio(found: Speedup | None) -> str:
    """Return a ratio's mean, geometric mean and range."""
    if found is None:
        return "–"
    mark = ">" if found.capped else ""
    mean, geometric = _short(found.mean), _short(found.geometric)
    span = f"{_short(found.least)}–{_short(found.most)}"
    return f"{mark}{mean}, {mark}{geometric} ({span})"


def _short(number: float) -> str:
    """Return a positive number to two digits, or whole where it has more before the point."""
    return f"{number:.0f}" if number >= 10.0 else f"{number:.2g}"


def _success_table(summaries: Sequence[Summary]) -> str:
    """Return successes and collision-free samples per method and size."""
    lines = [
        [
            f"`{s.method}`",
            str(s.vehicles),
            f"{s.plans} of {s.problems}",
            f"{s.successes} ({100.0 * s.successes / s.plans:.0f} %)" if s.plans else "–",
            str(s.surely_over),
            "–" if s.free is None else f"{s.free.median:.4f} ({s.free.low:.4f})",
        ]
        for s in summaries
    ]
    return _table(["method", "N", "plans", "successes", "surely above Δ", "samples free"], lines)


def _failures(rows: Sequence[Row], bound: float) -> str:
    """Return the plans above Δ by seed, and the problems without a plan."""
    over = [r for r in rows if r.has_plan and not r.is_success(bound)]
    lines = [
        f"- `{r.method}`, N = {r.vehicles}, seed {r.seed}: {r.rate:.4f} "
        f"({r.rate_low:.4f}–{r.rate_high:.4f}), certificate {min(r.certified or 0.0, 1.0):.4f}"
        for r in over[:_MOST_LISTED]
    ]
    if len(over) > _MOST_LISTED:
        lines.append(f"- and {len(over) - _MOST_LISTED} more")
    missing: dict[tuple[str, int], list[int]] = {}
    for row in rows:
        if not row.has_plan:
            missing.setdefault((row.method, row.vehicles), []).append(row.seed)
    lines += [
        f"- `{method}`, N = {n}: no plan for seeds {', '.join(map(str, sorted(seeds)))}"
        for (method, n), seeds in missing.items()
    ]
    return "\n".join(lines) or "None."


def _quality_table(summaries: Sequence[Summary]) -> str:
    """Return cost, share of Δ and couplings per method and size."""
    lines = [
        [
            f"`{s.method}`",
            str(s.vehicles),
            _percent(s.above_bound),
            _percent(s.used, digits=0),
            str(s.over),
            str(s.coupled_wrong),
        ]
        for s in summaries
    ]
    return _table(
        ["method", "N", "cost above bound [%]", "Δ used [%]", "above Δ", "missed couplings"], lines
    )


def _percent(quantiles: Quantiles | None, digits: int = 2) -> str:
    """Return a median with its 90th percentile in percent."""
    if quantiles is None:
        return "–"
    return f"{100.0 * quantiles.median:.{digits}f} ({100.0 * quantiles.high:.{digits}f})"


def _ablations(study: Study, rows: Sequence[Row]) -> list[str]:
    """Return what the other readings of the paper change, on the same problems."""
    lines = []
    base = {(r.vehicles, r.seed): r for r in rows if r.method == BASELINE}
    for method in study.available:
        if method.role != "ablation":
            continue
        pairs = [
            (base[(r.vehicles, r.seed)], r)
            for r in rows
            if r.method == method.name and (r.vehicles, r.seed) in base
        ]
        if pairs:
            lines.append([f"`{method.name}`", *_ablation_cells(pairs, study.risk_bound)])
    if not lines:
        return []
    head = [
        "reading", "problems", "same plan", "cost [%]", "plans above Δ, before", "after", "time"
    ]  # fmt: skip
    return ["## Other readings of the paper", _table(head, lines)]


def _ablation_cells(pairs: Sequence[tuple[Row, Row]], bound: float) -> list[str]:
    """Return how a reading differs from the baseline: median cost, failures, time."""
    both = [(a, b) for a, b in pairs if a.cost is not None and b.cost is not None]
    same = sum(abs((b.cost or 0.0) - (a.cost or 0.0)) <= 1e-9 * (a.cost or 1.0) for a, b in both)
    changes = Quantiles.of((b.cost or 0.0) / (a.cost or 1.0) - 1.0 for a, b in both)
    cost = "–"
    if changes is not None:
        low, middle, high = (100.0 * q for q in (changes.low, changes.median, changes.high))
        cost = f"{middle:+.2f} ({low:+.2f} to {high:+.2f})"
    time = Quantiles.of(b.seconds / a.seconds for a, b in pairs)
    return [
        str(len(pairs)),
        str(same),
        cost,
        str(sum(a.has_plan and not a.is_success(bound) for a, _ in pairs)),
        str(sum(b.has_plan and not b.is_success(bound) for _, b in pairs)),
        "–" if time is None else f"× {time.median:.2f}",
    ]
