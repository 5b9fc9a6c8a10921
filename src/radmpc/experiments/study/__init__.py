"""The paper's experiments done again: from seeds to tables and figures."""

from radmpc.experiments.study.design import Method, Study, full_study, quick_study
from radmpc.experiments.study.journal import Journal, read_rows
from radmpc.experiments.study.running import run_study
from radmpc.experiments.study.trial import Row, Task, run_task

__all__ = [
    "Journal",
    "Method",
    "Row",
    "Study",
    "Task",
    "full_study",
    "quick_study",
    "read_rows",
    "run_study",
    "run_task",
]
