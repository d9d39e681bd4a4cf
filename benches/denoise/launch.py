"""Runs a command: `launch.py FILE COMMAND …` writes its seconds and its peak memory in bytes to FILE.

The system counts the memory of the parent at the start of a process as memory of that process; this parent has almost none.
"""

import os
import sys
import time

start = time.perf_counter()
_, status, usage = os.wait4(os.posix_spawnp(sys.argv[2], sys.argv[2:], os.environ), 0)
with open(sys.argv[1], "w") as file:
    file.write(f"{time.perf_counter() - start} {usage.ru_maxrss * (1 if sys.platform == 'darwin' else 1024)}")
sys.exit(os.waitstatus_to_exitcode(status) % 256)
