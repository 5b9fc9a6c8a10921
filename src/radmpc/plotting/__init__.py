"""Pictures of scenarios and plans: each takes ``ax=None`` and returns the axes."""

from radmpc.plotting.plan import plot_plan
from radmpc.plotting.save import FIGURE_SUFFIXES, check_figure_path, save_figure
from radmpc.plotting.scenario import plot_scenario

__all__ = ["FIGURE_SUFFIXES", "check_figure_path", "plot_plan", "plot_scenario", "save_figure"]
