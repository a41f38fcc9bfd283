"""``linden serve`` that also writes what its ticks consist of into a file, for speed_table.py.

    python benchmarks/split_server.py FILE [options of linden serve]

The file holds sums in s as JSON: frames and what they show, of it sensors, and how long
answers waited for the cue.
"""

import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from linden.cli import main as linden
from linden.server import frames
from linden.server.cue import Cue
from linden.server.rpc.context import Context
from linden.world import World

WRITTEN_EACH = 50
"""Frames."""

sums = {"frames": 0.0, "frame_s": 0.0, "sensors_s": 0.0, "cue_s": 0.0}


def timed(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the function, which adds its time to a sum."""

    def call(*arguments: object) -> object:
        began_s = time.perf_counter()
        result = function(*arguments)
        sums[name] += time.perf_counter() - began_s
        return result

    return call


def watch(file: Path) -> None:
    """Have the server's functions add to the sums."""
    ticked_s = 0.0
    advance, ticked, finish = timed("frame_s", Context.advance), Cue.ticked, Cue.finish

    def advance_and_write(context: Context) -> object:
        result = advance(context)
        sums["frames"] += 1
        if sums["frames"] % WRITTEN_EACH == 0:
            file.write_text(json.dumps(sums), "utf-8")
        return result

    def begin(cue: Cue, answer: bytes, now_s: float) -> None:
        nonlocal ticked_s
        ticked_s = time.perf_counter()
        ticked(cue, answer, now_s)

    def end(cue: Cue) -> bytes:
        sums["cue_s"] += time.perf_counter() - ticked_s
        return finish(cue)

    Context.advance, Cue.ticked, Cue.finish = advance_and_write, begin, end
    frames.sensor_payloads, World.measure = (
        timed("sensors_s", frames.sensor_payloads),
        timed("sensors_s", World.measure),
    )


if __name__ == "__main__":
    watch(Path(sys.argv[1]))
    sys.exit(linden(["serve", *sys.argv[2:]]))
