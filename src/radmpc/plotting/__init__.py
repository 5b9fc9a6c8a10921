"""Pictures of scenarios and plans: each takes ``ax=None`` and returns the axes."""

from radmpc.plotting.ledger import plot_ledger, plot_risk_map
from radmpc.plotting.ledger_shares import plot_risk_shares
from radmpc.plotting.plan import plot_plan
from radmpc.plotting.save import FIGURE_SUFFIXES, check_figure_path, save_figure, save_ledger
from radmpc.plotting.scenario import plot_scenario

__all__ = [
    "FIGURE_SUFFIXES",
    "check_figure_path",
    "plot_ledger",
    "plot_plan",
    "plot_risk_map",
    "plot_risk_shares",
    "plot_scenario",
    "save_figure",
    "save_ledger",
]
