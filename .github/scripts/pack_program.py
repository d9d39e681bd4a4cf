"""Packs the program with its licenses, completions and manual pages into an archive, unpacks it, and uses it.

python pack_program.py FOLDER TARGET OUT    FOLDER: where cargo wrote `adwave`; TARGET: such as x86_64-apple-darwin
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: Files of the repository in every archive.
FILES = ("README.md", "CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE", "crates/adwave-cli/THIRD-PARTY-NOTICES.txt")
#: Shells with the file of their completions.
COMPLETIONS = {"bash": "adwave.bash", "zsh": "_adwave", "fish": "adwave.fish", "powershell": "adwave.ps1"}


def version() -> str:
    """Version of the workspace."""
    found = re.search(r'^version = "(.+)"$', (ROOT / "Cargo.toml").read_text(encoding="utf-8"), re.MULTILINE)
    if found is None:
        raise ValueError("Cargo.toml must have a version")
    return found[1]


def pack(built: Path, target: str, out: Path) -> Path:
    """Write the archive of a program; returns its path."""
    name = f"adwave-{version()}-{target}"
    program = built / ("adwave.exe" if "windows" in target else "adwave")
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) / name
        (folder / "completions").mkdir(parents=True)
        shutil.copy2(program, folder)
        for file in FILES:
            shutil.copy2(ROOT / file, folder)
        for shell, file in COMPLETIONS.items():
            done = subprocess.run([program, "completions", shell], check=True, capture_output=True)
            (folder / "completions" / file).write_bytes(done.stdout)
        subprocess.run([program, "man", "-o", folder / "man"], check=True)
        out.mkdir(parents=True, exist_ok=True)
        kind = "zip" if "windows" in target else "gztar"
        return Path(shutil.make_archive(str(out / name), kind, temporary, name))


def use(archive: Path, target: str) -> None:
    """Unpack an archive and denoise a shape with its program.

    Raises
    ------
    subprocess.CalledProcessError
        If the program fails.
    """
    with tempfile.TemporaryDirectory() as temporary:
        shutil.unpack_archive(archive, temporary)
        folder = Path(temporary) / f"adwave-{version()}-{target}"
        program = folder / ("adwave.exe" if "windows" in target else "adwave")
        for line in ("sample bracket --vertices 3000 --noise 0.3 -o scan.obj", "denoise scan.obj -o clean.obj"):
            subprocess.run([program, *line.split()], check=True, cwd=temporary)
        if not (Path(temporary) / "clean.obj").exists():
            raise FileNotFoundError("the program wrote no clean.obj")


def main() -> None:
    built, target, out = Path(sys.argv[1]).resolve(), sys.argv[2], Path(sys.argv[3]).resolve()
    archive = pack(built, target, out)
    use(archive, target)
    print(f"{archive.name}: {archive.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
