"""Processes that answer requests, and how they take turns."""

import json
import queue
import statistics
import subprocess
import sys
import threading
import time
from pathlib import Path

# What the first seconds after a call may still be busy with: threads of a pool that spin before they sleep.
PAUSE = 0.25
# No call of any program takes so long where all is well.
MOST_SECONDS = 240


class Failure(Exception):
    """A program could not be started, failed, or took too long."""


class Program:
    """A process that answers each line of its input with a line of JSON."""

    def __init__(self, command, log):
        self.log = open(log, "w")
        self.process = subprocess.Popen(
            [str(c) for c in command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.log, text=True
        )
        self.name = Path(log).stem
        self.lines = queue.Queue()
        threading.Thread(target=self._listen, daemon=True).start()
        try:
            self.ready = self._answer()
        except Failure:
            self.close()
            raise

    def _listen(self):
        for line in self.process.stdout:
            self.lines.put(line)
        self.lines.put(None)

    def _answer(self):
        try:
            line = self.lines.get(timeout=MOST_SECONDS)
        except queue.Empty:
            self.process.kill()
            raise Failure(f"no answer within {MOST_SECONDS} s") from None
        if line is None:
            self.log.flush()
            last = Path(self.log.name).read_text().strip().splitlines()[-1:] or ["no word why"]
            raise Failure(f"ended: {last[0]}")
        answer = json.loads(line)
        if "error" in answer:
            raise Failure(answer["error"])
        return answer

    def ask(self, request):
        try:
            self.process.stdin.write(request + "\n")
            self.process.stdin.flush()
        except OSError as error:
            raise Failure(f"ended: {error}") from None
        return self._answer()

    def close(self):
        self.process.stdin.close()
        try:
            self.process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            self.process.kill()
        self.log.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


class Peer(Program):
    """One of the classes of `peers.py`."""

    def __init__(self, kind, folder, log):
        super().__init__([sys.executable, Path(__file__).parent / "peers.py", kind, folder], log)

    def call(self, *request):
        return self.ask(json.dumps(request))


def summary(answers):
    """The answers of one call repeated: least and median seconds, the highest memory, and what else the last one said."""
    seconds = [a["seconds"] for a in answers]
    peaks = [a["peak"] for a in answers if a.get("peak") is not None]
    return {
        **answers[-1],
        "seconds": None,
        "min": min(seconds),
        "median": statistics.median(seconds),
        "max": max(seconds),
        "repeats": len(seconds),
        "peak": max(peaks, default=None),
    }


def in_turns(calls, rounds):
    """Makes calls in turns, `(call, times in a row)` one after the other, as many rounds; their summaries."""
    answers = [[] for _ in calls]
    for _ in range(rounds):
        for (call, times), kept in zip(calls, answers):
            kept += [call() for _ in range(times)]
            time.sleep(PAUSE)
    return [summary(kept) for kept in answers]
