"""Other groups' problems: imported as they are, planned by `certified`, judged from the file.

    python benchmarks/instances.py [--time-limit 60] [FOLDER ...]

One row per problem: what planning ended with, cost and gap, certificate, what 100,000 simulated
missions found, seconds.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from radmpc import certify, import_scenario, plan, simulate
from radmpc.errors import RadmpcError

SUFFIXES = {".yaml", ".json", ".geojson", ".kml", ".scen"}
FOLDER = Path(__file__).parent.parent / "instances"


def row(path: Path, time_limit: float) -> str:
    """Import, plan and judge one problem."""
    scenario = import_scenario(path).scenario
    began = time.perf_counter()
    result = plan(scenario, time_limit=time_limit, rng=0)
    seconds = time.perf_counter() - began
    head = f"{path.stem:34} {scenario.num_vehicles:3} {scenario.horizon:3} {seconds:6.1f}"
    if result.plan is None or result.cost is None or result.lower_bound is None:
        return f"{head}  {result.status.value}: {result.explanation}"
    gap = 100.0 * (1.0 - result.lower_bound / result.cost) if result.cost else 0.0
    certificate, rate = certify(result.plan), simulate(result.plan, 100_000, rng=1).rate
    verdict = "holds" if certificate.holds and rate <= scenario.risk_bound else "FAILS"
    return (
        f"{head}  {result.status.value:9} {result.cost:9.4f} {gap:5.1f} % "
        f"{certificate.certified:9.4f} {rate:9.5f}  {verdict}"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folders", nargs="*", type=Path, default=[FOLDER])
    parser.add_argument("--time-limit", type=float, default=60.0)
    given = parser.parse_args()
    print(f"{'problem':34} {'N':>3} {'T':>3} {'s':>6}  status, cost, gap, certificate, simulated")
    for folder in given.folders:
        for path in sorted(p for p in folder.rglob("*") if p.suffix in SUFFIXES):
            try:
                print(row(path, given.time_limit), flush=True)
            except RadmpcError as error:
                print(f"{path.stem:34} {error}", flush=True)


if __name__ == "__main__":
    main()
