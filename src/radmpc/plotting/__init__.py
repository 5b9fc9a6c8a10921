"""Pictures of scenarios and plans: each takes ``ax=None`` and returns the axes."""

from radmpc.plotting.ledger import plot_ledger, plot_risk_map
from radmpc.plotting.ledger_shares import plot_risk_shares
from radmpc.plotting.panels import Panel, plot_panels
from radmpc.plotting.plan import plot_plan
from radmpc.plotting.save import (
    FIGURE_SUFFIXES,
    check_figure_path,
    save_figure,
    save_ledger,
    write_figure,
)
from radmpc.plotting.scenario import plot_scenario
from radmpc.plotting.spread import Spread, plot_spread

__all__ = [
    "FIGURE_SUFFIXES",
    "Panel",
    "Spread",
    "check_figure_path",
    "plot_ledger",
    "plot_panels",
    "plot_plan",
    "plot_risk_map",
    "plot_risk_shares",
    "plot_scenario",
    "plot_spread",
    "save_figure",
    "save_ledger",
    "write_figure",
]
