"""The machine and the software of the measurements."""

import os
import platform
import subprocess
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import psutil

PACKAGES = ("numpy", "scipy", "mkl", "sparse_dot_mkl", "suitesparse-graphblas", "python-graphblas", "vtk", "PyGSP")


def installed(name):
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def describe():
    fields = {}
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            key, _, value = line.partition(":")
            fields.setdefault(key.strip(), value.strip())
    except OSError:
        pass
    flags = fields.get("flags", "").split()
    caches = {}
    for index in sorted(Path("/sys/devices/system/cpu/cpu0/cache").glob("index*")):
        level, kind, size = ((index / n).read_text().strip() for n in ("level", "type", "size"))
        if kind != "Instruction":
            caches[f"L{level}"] = size
    return {
        "cpu": f"{fields.get('model name', platform.processor())}, family {fields.get('cpu family', '?')}",
        "cores": os.cpu_count(),
        "virtual": "hypervisor" in flags,
        "vectors": [f for f in ("avx2", "avx512f", "asimd") if f in flags],
        "caches": caches,
        "memory": psutil.virtual_memory().total,
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "rustc": subprocess.run(["rustc", "--version"], capture_output=True, text=True).stdout.split()[1],
        "packages": {name: installed(name) for name in PACKAGES},
    }
