"""Checks that a folder has the wheels of all systems and the source distribution, of one version, none too large.

python check_dist.py FOLDER
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

#: A pattern for the tag of each system.
SYSTEMS = {
    "Linux with glibc, x86-64": r"manylinux.*_x86_64",
    "Linux with glibc, ARM": r"manylinux.*_aarch64",
    "Linux with musl, x86-64": r"musllinux_1_2_x86_64",
    "Linux with musl, ARM": r"musllinux_1_2_aarch64",
    "macOS, Intel": r"macosx_\d+_\d+_x86_64",
    "macOS, Apple silicon": r"macosx_\d+_\d+_arm64",
    "Windows": r"win_amd64",
}
#: Most bytes of a wheel.
MOST_BYTES = 8_000_000
WHEEL = re.compile(r"adwave-(?P<version>[^-]+)-cp310-abi3-(?P<system>.+)\.whl")
SDIST = re.compile(r"adwave-(?P<version>.+)\.tar\.gz")


def faults(sizes: dict[str, int]) -> list[str]:
    """Faults of files, given by their sizes in bytes."""
    found, systems, versions, n_sdists = [], [], set(), 0
    for name, size in sorted(sizes.items()):
        wheel, sdist = WHEEL.fullmatch(name), SDIST.fullmatch(name)
        if wheel is not None:
            systems.append(wheel["system"])
            versions.add(wheel["version"])
            if size > MOST_BYTES:
                found.append(f"{name} must have at most {MOST_BYTES} bytes, got {size}")
        elif sdist is not None:
            n_sdists += 1
            versions.add(sdist["version"])
        else:
            found.append(f"{name} is neither a wheel for every Python from 3.10 on nor a source distribution")
    for system, pattern in SYSTEMS.items():
        n_wheels = sum(re.fullmatch(rf"(?:.*\.)?{pattern}(?:\..*)?", tag) is not None for tag in systems)
        if n_wheels != 1:
            found.append(f"there must be one wheel for {system}, got {n_wheels}")
    if n_sdists != 1:
        found.append(f"there must be one source distribution, got {n_sdists}")
    if len(versions) != 1:
        found.append(f"all files must have one version, got {', '.join(sorted(versions)) or 'none'}")
    return found


def main() -> int:
    sizes = {path.name: path.stat().st_size for path in Path(sys.argv[1]).iterdir()}
    found = faults(sizes)
    print("\n".join(found) or f"{len(sizes)} files for {len(SYSTEMS)} systems")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
