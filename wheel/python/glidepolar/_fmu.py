"""Where the packed FMUs of the underwater glider are."""

from __future__ import annotations

from importlib.metadata import files
from pathlib import Path

_NAMES = {2: "UnderwaterGlider_fmi2.fmu", 3: "UnderwaterGlider.fmu"}


def fmu_path(fmi_version: int = 3) -> str:
    """Returns the path of the default glider's FMU for FMI 3 or 2."""
    if fmi_version not in _NAMES:
        raise ValueError(f"there is no FMU for FMI {fmi_version}: choose 2 or 3")
    name = _NAMES[fmi_version]
    for file in files("glidepolar") or []:
        if file.name == name:
            return str(Path(str(file.locate())).resolve())
    raise FileNotFoundError(f"this installation lacks {name}: install the wheel again")
