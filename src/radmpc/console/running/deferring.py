"""What numpy loads for scipy and nobody uses here waits until somebody does.

As scipy starts it copies every public name of numpy, for which numpy loads all its parts, those for
Fortran and for tests among them: 109 modules, a tenth of the time of `plan` for two vehicles.
"""

from __future__ import annotations

import sys
from importlib.util import LazyLoader, find_spec, module_from_spec

__all__ = ["defer"]


def defer(package: str, *parts: str) -> None:
    """Put off loading parts of a package until one of their names is asked for.

    Parameters
    ----------
    package : str
        It is loaded now.
    parts : str
        Names of its modules; those already loaded, and those it does not have, are left alone.
    """
    for part in parts:
        name = f"{package}.{part}"
        spec = None if name in sys.modules else find_spec(name)
        if spec is None or spec.loader is None:
            continue
        spec.loader = LazyLoader(spec.loader)
        module = module_from_spec(spec)
        sys.modules[name] = module
        # As a finished import would: the package is asked first, and would load what it lacks.
        setattr(sys.modules[package], part, module)
        spec.loader.exec_module(module)
