"""Problems of other groups as scenarios: what their files leave open is chosen, and reported."""

from radmpc.importing.formats import ImportedScenario, import_scenario
from radmpc.importing.options import ImportOptions

__all__ = ["ImportOptions", "ImportedScenario", "import_scenario"]
