"""A flight log as it would read if flooded spaces of the glider took their water along.

    python examples/carried_water.py LOG.csv --share 0.3 --exchange-s 200 --output carried.csv
    glidepolar diagnose carried.csv --vehicle slocum-graver

Nose, tail and wing roots of a glider are open to the sea. What water they hold changes with the one outside, of density rho,
in an exchange time: d(rho_in)/dt = (rho - rho_in)/exchange. A glider that displaces V beside flooded spaces of share x V then
weighs

    m - rho V + (rho_in - rho) x V = m - (rho + x (rho - rho_in)) V

in water: as one without such spaces in water of density rho + x (rho - rho_in). That is what stands in the new log's
density_kg_m3, for programs that know of no flooded spaces. Temperature, salinity and conductivity are left out: they belong
to another density.

Needs nothing but Python.
"""

import argparse
import csv
import math
import sys
from pathlib import Path

DENSITY, TIME = "density_kg_m3", "time_s"
# What a density could be computed from anew.
LEFT_OUT = {"temperature_C", "salinity_psu", "conductivity_S_m"}
# After a gap as long as this many exchange times nothing is left of the water before it.
FORGOTTEN = 20


def main() -> int:
    arguments = parse()
    try:
        with arguments.log.open(newline="") as file:
            rows = list(csv.DictReader(file))
        missing = {DENSITY, TIME} - set(rows[0] if rows else {})
        if missing:
            raise ValueError(f"no {' and no '.join(sorted(missing))} in it")
        most = carry(rows, arguments.share, arguments.exchange_s)
        columns = [name for name in rows[0] if name not in LEFT_OUT]
        with arguments.output.open("w", newline="") as file:
            writer = csv.DictWriter(file, columns, extrasaction="ignore", lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    except (OSError, ValueError) as error:
        print(f"error: {arguments.log}: {error}", file=sys.stderr)
        return 1
    print(f"{len(rows)} rows; the water carried along makes up for {most:.3f} kg/m3 at most")
    return 0


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log", type=Path, help=f"table with {TIME} and {DENSITY}")
    parser.add_argument("--share", type=float, default=0.3, help="flooded volume over the displaced one (default 0.3)")
    parser.add_argument("--exchange-s", type=float, default=200.0, help="time in which the water changes (default 200 s)")
    parser.add_argument("--output", type=Path, required=True, help="where the new log goes")
    arguments = parser.parse_args()
    if not (0 <= arguments.share < 10 and 0 < arguments.exchange_s < math.inf):
        parser.error("a share from 0 to 10 and a time above 0 are expected")
    return arguments


def carry(rows: list[dict[str, str]], share: float, exchange_s: float) -> float:
    """Puts the felt density in place of the measured one, row by row; the largest change."""
    inside = before_s = None
    most = 0.0
    for row in rows:
        outside, time_s = number(row[DENSITY]), number(row[TIME])
        if outside is None or time_s is None:
            continue
        if inside is None or not 0 <= time_s - before_s <= FORGOTTEN * exchange_s:
            inside = outside
        else:
            inside = outside + (inside - outside) * math.exp(-(time_s - before_s) / exchange_s)
        before_s = time_s
        felt = outside + share * (outside - inside)
        most = max(most, abs(felt - outside))
        row[DENSITY] = f"{felt:.4f}"
    return most


def number(cell: str) -> float | None:
    try:
        value = float(cell)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


if __name__ == "__main__":
    sys.exit(main())
