"""`python -m adwave.blender`: writes the add-on for Blender, with the installed package as a wheel inside.

Blender installs the wheels of an extension by itself, so that nobody needs its Python. A wheel is for one kind of machine; for several,
give each with `--wheel`.
"""

from __future__ import annotations

import argparse
import base64
import hashlib
import io
import sys
import zipfile
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path, PurePosixPath

MANIFEST = """schema_version = "1.0.0"
id = "adwave"
version = "{version}"
name = "adwave"
tagline = "An equalizer for shapes: smooth, enhance and denoise by bands"
maintainer = "The adwave developers"
type = "add-on"
blender_version_min = "4.2.0"
license = ["SPDX:MIT", "SPDX:Apache-2.0"]
tags = ["Mesh", "Modeling", "Sculpt"]
"""

#: Blender's names of machines by what the names of their wheels hold; Windows and macOS are told apart first.
PLATFORMS = (
    ("win_amd64", "windows-x64"),
    ("win_arm64", "windows-arm64"),
    ("macosx", "arm64", "macos-arm64"),
    ("macosx", "x86_64", "macos-x64"),
    ("macosx", "universal2", "macos-arm64"),
    ("linux", "x86_64", "linux-x64"),
    ("linux", "aarch64", "linux-arm64"),
)


def platform_of(wheel: str) -> str:
    """Blender's name of the platform of a wheel.

    >>> platform_of("adwave-0.1.0-cp310-abi3-manylinux_2_17_x86_64.manylinux2014_x86_64.whl")
    'linux-x64'
    >>> platform_of("adwave-0.1.0-cp310-abi3-macosx_11_0_arm64.whl")
    'macos-arm64'
    """
    machine = wheel.removesuffix(".whl").rsplit("-", 1)[-1]
    for *parts, name in PLATFORMS:
        if all(part in machine for part in parts):
            return name
    raise ValueError(f"{wheel}: Blender runs on no {machine!r}; give a wheel for Windows, macOS or Linux")


def installed_wheel() -> tuple[str, bytes]:
    """Name and content of the wheel that the installed package came from.

    Raises
    ------
    ValueError
        It was not installed from a wheel.
    """
    try:
        found = metadata.distribution("adwave")
    except metadata.PackageNotFoundError:
        raise ValueError("adwave runs from a folder and is not installed") from None
    tags = [
        line.split(":", 1)[1].strip()
        for line in (found.read_text("WHEEL") or "").splitlines()
        if line.startswith("Tag:")
    ]
    files = [file for file in found.files or [] if _of_wheel(file)]
    if not tags or not any("_native" in file.name for file in files):
        raise ValueError("adwave was not installed from a wheel")
    python, abi = tags[0].split("-")[:2]
    machine = ".".join(tag.split("-")[2] for tag in tags)
    content, record, lists = io.BytesIO(), [], ""
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in files:
            if file.name == "RECORD":
                lists = file.as_posix()
                continue
            data = Path(str(found.locate_file(file))).read_bytes()
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            record.append(f"{file.as_posix()},sha256={digest},{len(data)}\n")
            archive.writestr(file.as_posix(), data)
        archive.writestr(lists, "".join([*record, f"{lists},,\n"]))
    return f"adwave-{found.version}-{python}-{abi}-{machine}.whl", content.getvalue()


def _of_wheel(file: PurePosixPath) -> bool:
    """True if a file belongs to the wheel and was not written by the installation."""
    made = ("INSTALLER", "REQUESTED", "direct_url.json")
    return ".." not in file.parts and "__pycache__" not in file.parts and file.name not in made


def write_addon(path: Path, wheels: Sequence[Path] | None = None) -> str:
    """Write the add-on, and print its content.

    Parameters
    ----------
    path : Path
    wheels : sequence of Path, optional
        Wheels of adwave, one for each kind of machine; the installed package where nothing is given, none where that is empty.
    """
    if wheels is None:
        inside = dict([installed_wheel()])
    else:
        inside = {wheel.name: wheel.read_bytes() for wheel in wheels}
    platforms = sorted({platform_of(name) for name in inside})
    manifest = MANIFEST.format(version=_version())
    if inside:
        manifest += f"platforms = {_toml(platforms)}\nwheels = {_toml(f'./wheels/{name}' for name in inside)}\n"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("blender_manifest.toml", manifest)
        archive.writestr("__init__.py", Path(__file__).with_name("_blender_init.py").read_text(encoding="utf-8"))
        for name, content in inside.items():
            archive.writestr(f"wheels/{name}", content)
    if not inside:
        return f"{path}: without adwave itself; the add-on says how to install it into Blender's Python"
    return f"{path}: adwave for {', '.join(platforms)}"


def _toml(texts: object) -> str:
    return "[" + ", ".join(f'"{text}"' for text in texts) + "]"  # type: ignore[attr-defined]


def _version() -> str:
    from adwave import __version__

    return __version__


def main(arguments: Sequence[str] | None = None) -> int:
    """Run ``python -m adwave.blender``; returns its exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m adwave.blender", description="Write the add-on for Blender 4.2 and newer."
    )
    parser.add_argument(
        "--zip", type=Path, required=True, metavar="FILE", help="the add-on, such as adwave-blender.zip"
    )
    parser.add_argument(
        "--wheel",
        type=Path,
        action="append",
        metavar="FILE",
        help="a wheel of adwave in the place of the installed package; once for each kind of machine",
    )
    parser.add_argument("--without-wheel", action="store_true", help="for a Blender whose Python has adwave")
    given = parser.parse_args(arguments)
    try:
        print(write_addon(given.zip, [] if given.without_wheel else given.wheel))
    except (ValueError, OSError) as error:
        hint = "; give one with --wheel FILE, or take --without-wheel" if given.wheel is None else ""
        print(f"error: {error}{hint}", file=sys.stderr)
        return 1
    return 0
