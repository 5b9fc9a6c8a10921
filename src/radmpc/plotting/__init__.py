"""Pictures of scenarios and plans: each takes ``ax=None`` and returns the axes."""

from radmpc.plotting.chart import Chart, Spread, plot_chart
from radmpc.plotting.couplings import plot_couplings
from radmpc.plotting.distances import plot_distances
from radmpc.plotting.film.animation import PlanAnimation, animate_plan
from radmpc.plotting.film.films import FILM_SUFFIXES, check_film_path, save_animation
from radmpc.plotting.flight.film import save_flight_film
from radmpc.plotting.flight.picture import plot_flight, save_flight
from radmpc.plotting.panels import Panel, plot_panels
from radmpc.plotting.plan import plot_plan, plot_views
from radmpc.plotting.risk.ledger_picture import plot_ledger, plot_risk_map
from radmpc.plotting.risk.ledger_shares import plot_risk_shares
from radmpc.plotting.risk.risk_steps import plot_risk
from radmpc.plotting.save import (
    FIGURE_SUFFIXES,
    check_figure_path,
    save_axes,
    save_chart,
    save_figure,
    save_ledger,
    save_panels,
)
from radmpc.plotting.scenario import plot_scenario
from radmpc.plotting.sweep import CostPoint, plot_costs

__all__ = [
    "FIGURE_SUFFIXES",
    "FILM_SUFFIXES",
    "Chart",
    "CostPoint",
    "Panel",
    "PlanAnimation",
    "Spread",
    "animate_plan",
    "check_figure_path",
    "check_film_path",
    "plot_chart",
    "plot_costs",
    "plot_couplings",
    "plot_distances",
    "plot_flight",
    "plot_ledger",
    "plot_panels",
    "plot_plan",
    "plot_risk",
    "plot_risk_map",
    "plot_risk_shares",
    "plot_scenario",
    "plot_views",
    "save_animation",
    "save_axes",
    "save_chart",
    "save_figure",
    "save_flight",
    "save_flight_film",
    "save_ledger",
    "save_panels",
]
