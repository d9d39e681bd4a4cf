"""Run the examples in order, one line each: name, seconds, and ok, skipped or failed.

python run_all.py
python run_all.py --only denoise
python run_all.py --quick       a twentieth of the million points
"""

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

EXAMPLES = (
    "smooth_a_scan",
    "local_edit",
    "denoise",
    "an_animation",
    "saliency_and_features_with_pyvista",
    "cortical_fields",
    "fmri_on_a_surface",
    "images_and_volumes",
    "diffusion_tensors",
    "wind_on_a_sphere",
    "graph",
    "cells",
    "million_points",
    "classify_with_scikit_learn",
)


def run(name: str, scale: str) -> tuple[str, str]:
    """Run an example in a process of its own; returns its status and a note."""
    # UTF-8 on any system, for signs such as σ.
    environment = {**os.environ, "PYTHONUTF8": "1", "ADWAVE_GALLERY_SCALE": scale}
    script = str(Path(__file__).resolve().parent / f"{name}.py")
    done = subprocess.run(
        [sys.executable, script], check=False, capture_output=True, encoding="utf-8", env=environment
    )
    if done.returncode != 0:
        return "failed", f"\n{done.stdout}{done.stderr}"
    skipped = [line for line in done.stdout.splitlines() if line.startswith("skipped: ")]
    return ("skipped", skipped[0].removeprefix("skipped")) if skipped else ("ok", "")


def main() -> int:
    parser = argparse.ArgumentParser(description="Run the examples.")
    parser.add_argument("--only", metavar="NAME", choices=EXAMPLES, action="append", help="may be repeated")
    parser.add_argument("--quick", action="store_true", help="use fewer points in the example with a million")
    arguments = parser.parse_args()
    chosen = arguments.only or EXAMPLES
    scale = "0.05" if arguments.quick else os.environ.get("ADWAVE_GALLERY_SCALE", "1.0")
    failed = 0
    for name in EXAMPLES:
        if name not in chosen:
            continue
        start = time.perf_counter()
        ending, note = run(name, scale)
        print(f"{name:<36} {time.perf_counter() - start:6.1f} s  {ending}{note}", flush=True)
        failed += ending == "failed"
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
