"""The command `adwave`, as ``python -m adwave`` or by the script of that name."""

from __future__ import annotations

import sys

from adwave import _native


def main() -> int:
    """Run the command line, and give its exit code."""
    try:
        return _native.run_command(["adwave", *sys.argv[1:]])
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main())
