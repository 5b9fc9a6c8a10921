"""The price of risk.

The same boat must pass the end of a pier, and the risk bound Δ decides how closely. Collisions
count at the steps, and only at step 5 is the boat beside the pier. All of Δ is used there: it
passes radius + Φ⁻¹(1 - Δ) σ beside the pier's end, and being that far aside at half time costs
just as much. The planner's costs (dots) for ten bounds must lie on this curve, whose slope is the
shadow price of risk; the number is the largest distance from it, relative to the cost.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy.special import ndtri

import radmpc

EXPECTED = 0.0
TOLERANCE = 0.002  # the planner proves its plans optimal within 0.1 %

HORIZON, WAY, RADIUS = 10, 27.0, 0.4
POSITION_NOISE, VELOCITY_NOISE = 0.004, 0.0004  # variances per step [m²], [m²/s²]


def main(out: Path) -> float:
    """Plan for ten risk bounds, draw, and return how far the costs are from the closed form."""
    noise = 2 * [POSITION_NOISE] + 2 * [VELOCITY_NOISE]
    goal = radmpc.Goal([WAY, 0.0], [WAY, 0.0], speed=[0.0, 0.0])
    system = radmpc.double_integrator(1.0, dimension=2)
    boat = radmpc.Vehicle("boat", system, np.zeros(4), goal, RADIUS, [4.0, 4.0], noise, noise)
    pier = radmpc.Obstacle.box("pier", [12.0, -4.0], [15.0, 0.0])
    scenario = radmpc.Scenario("pier", 1.0, HORIZON, 0.05, (boat,), (pier,), avoidance="steps")
    bounds = np.geomspace(1e-4, 0.3, 10)
    plans = [radmpc.plan(replace(scenario, risk_bound=d)).require() for d in bounds]
    costs = np.array([plan.cost for plan in plans])
    # Variance of the position at step 5: noise of the start and of five steps.
    sigma = np.sqrt(6 * POSITION_NOISE + (25 + 16 + 9 + 4 + 1) * VELOCITY_NOISE)
    curve = 2 * WAY / (HORIZON - 1) + RADIUS - ndtri(bounds) * sigma

    figure = Figure(figsize=(3.5, 3.4), dpi=200, layout="constrained")
    upper, lower = figure.subplots(2, 1, height_ratios=[1, 2])
    radmpc.plot_plan(plans[0], upper, details=False)
    lower.semilogx(bounds, curve, label="closed form")
    lower.semilogx(bounds, costs, "o", markersize=3.5, label="planned")
    lower.set_xlabel("risk bound Δ [-]", fontsize=6.5)
    lower.set_ylabel("least effort [m/s²]", fontsize=6.5)
    lower.tick_params(labelsize=6)
    lower.legend(fontsize=6.5)
    figure.savefig(out / "02_price_of_risk.png")
    return float(np.max(np.abs(costs / curve - 1.0)))


if __name__ == "__main__":
    print("largest relative distance from the closed form:", main(Path()))
