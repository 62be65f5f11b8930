"""Download one source package by name and version: fetch_sdist.py NAME VERSION FILE.

`pip download` would run the package's build scripts to learn its dependencies; only the file is wanted here. So
pip's own finder (with the index, proxy and certificates that pip is set up with) names the file, and pip's own
session fetches it. Whether it is the right file is for the caller to check, by its SHA-256.
"""

import sys

from pip._internal.commands import create_command
from pip._vendor.packaging.specifiers import SpecifierSet

CHUNK_BYTES = 1 << 16
# The largest of the packages has 20 MB.
LIMIT_BYTES = 200 << 20


def main(name: str, version: str, path: str) -> None:
    download = create_command("download")
    options, _ = download.parse_args(["--no-binary", ":all:", "--quiet", name])
    with download.main_context():
        session = download.get_default_session(options)
        finder = download._build_package_finder(options, session)
        found = finder.find_best_candidate(name, specifier=SpecifierSet(f"=={version}")).best_candidate
        if found is None:
            raise SystemExit(f"no source package of {name} {version} in the package index that pip is set up with")
        response = session.get(found.link.url_without_fragment, stream=True, headers={"Accept-Encoding": "identity"})
        response.raise_for_status()
        size = 0
        with open(path, "wb") as file:
            for chunk in response.iter_content(CHUNK_BYTES):
                size += len(chunk)
                if size > LIMIT_BYTES:
                    raise SystemExit(f"{name} {version} is larger than {LIMIT_BYTES} bytes")
                file.write(chunk)


if __name__ == "__main__":
    main(*sys.argv[1:])
