"""Writes what dbdreader reads from the files of its own source package: dbdreader_values.py DATA > dbdreader_values.csv.

For each file the number of values and a CRC-32 over all of them: for each sensor in the order of names its name, the number
of its values (8 bytes) and the values (float64), the least significant byte first. Files that dbdreader refuses have none.
"""

import struct
import sys
import zlib
from pathlib import Path

import dbdreader


def main(data: Path) -> None:
    print("file,values,crc32")
    files = [path for path in data.iterdir() if len(path.suffix) == 4 and path.suffix[2].lower() in "bc"]
    for path in sorted(path for path in files if path.suffix[3].lower() == "d"):
        try:
            file = dbdreader.DBD(str(path), cacheDir=str(data / "cac"), skip_initial_line=False)
            names = sorted(file.parameterNames)
            columns = file.get(*names, decimalLatLon=False, discardBadLatLon=False)
        except dbdreader.DbdError:
            print(f"{path.name},,")
            continue
        total, crc = 0, 0
        for name, (_, values) in zip(names, columns, strict=True):
            numbers = struct.pack(f"<{len(values)}d", *values)
            crc = zlib.crc32(numbers, zlib.crc32(name.encode() + struct.pack("<Q", len(values)), crc))
            total += len(values)
        print(f"{path.name},{total},{crc:08x}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
