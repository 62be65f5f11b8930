"""An underwater glider from the towing tank to the sea and back.

    import glidepolar

    found = glidepolar.identify("flight.csv", "slocum-049")     # files of any maker, or a DataFrame
    found.parameters["b"].value, found.to_dict(), found.report("identified/")
    glidepolar.diagnose("flight.csv", "my-glider.toml").vehicle.save("better.toml")
    glidepolar.Vehicle("slocum-049").fmu("Slocum.fmu")

Each function does the work of the command of its name: `glidepolar NAME --help`. Results are those of the commands, to the
last digit. Names carry the units. Errors are `glidepolar.errors.InputError` and its like, with file, line and hint.
"""

from importlib.metadata import version

from . import tank
from ._fmu import fmu_path
from ._functions import compare, diagnose, glide, identify, plan, simulate, track, turn
from ._log import Log, read
from ._results import Estimate
from ._vehicle import Vehicle
from .errors import GlidepolarError, InputError, NoAnswerError, OutputError

__all__ = [
    "Estimate",
    "GlidepolarError",
    "InputError",
    "Log",
    "NoAnswerError",
    "OutputError",
    "Vehicle",
    "__version__",
    "compare",
    "diagnose",
    "fmu_path",
    "glide",
    "identify",
    "plan",
    "read",
    "simulate",
    "tank",
    "track",
    "turn",
]

__version__ = version("glidepolar")
