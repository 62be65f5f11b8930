"""Where the packed FMUs of the underwater glider are.

    import fmpy, glidepolar
    result = fmpy.simulate_fmu(glidepolar.fmu_path(), stop_time=1000)

Everything else is done by the commands `glidepolar` and `tank-reduce`, which this package installs.
"""

from importlib.metadata import files, version
from pathlib import Path

__all__ = ["__version__", "fmu_path"]

__version__ = version("glidepolar")

_NAMES = {2: "UnderwaterGlider_fmi2.fmu", 3: "UnderwaterGlider.fmu"}


def fmu_path(fmi_version: int = 3) -> str:
    """The FMU of the default glider for FMI 3 or 2, as a path."""
    if fmi_version not in _NAMES:
        raise ValueError(f"there is no FMU for FMI {fmi_version}: choose 2 or 3")
    name = _NAMES[fmi_version]
    for file in files("glidepolar") or []:
        if file.name == name:
            return str(Path(file.locate()).resolve())
    raise FileNotFoundError(f"this installation lacks {name}: install the wheel again")
