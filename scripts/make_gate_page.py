"""Write docs/reference/gate.md from the gate's table of calls: `make_gate_page.py [--check]`."""

from __future__ import annotations

import sys
from pathlib import Path

from generated_page import write_or_check

from linden.gate.calls import CALLS, Rule

PAGE = Path(__file__).parent.parent / "docs" / "reference" / "gate.md"
HEAD = """# The gate: what an agent may call

<!-- written by scripts/make_gate_page.py -->

An agent's client connects to a gate, behind which it can drive its own vehicle and change nothing else. A refused call
raises `RuntimeError` with a sentence where the client waits for an answer. Refusals are counted in the run's result and
do not end the run. A function that is not named here is refused.

| track | what the agent learns of other actors |
|---|---|
| `world` | all of them |
| `objects` | those in line of sight of its vehicle, lights and signs |
| `sensors` | none: its snapshots hold its own vehicle only |

`linden gate --port 2000 --vehicle 24` puts a gate before a running server, CARLA's own included. Without `--vehicle` it
takes orders, one JSON object a line on stdin, as `linden serve --gates` does:

    {"open": {"vehicle": 24, "track": "objects", "known": [3, 4], "agent": 71}}
                                                   {"gate": {"rpc": 40001, "streaming": 40002}}
    {"sensors": {"vehicle": 24, "ids": [25, 26]}}  {"gate": {}}
    {"see": {"vehicle": 24, "frame": 1200, "ids": [31, 32]}}
                                                   (no answer)
    {"close": {"vehicle": 24}}                     {"gate": {"refused": {"tick_cue": 1}}}

There may be a gate for each of several vehicles at once, each with two ports of its own. A second gate for a vehicle
closes the first one.

`agent` is the agent's process. On Linux the gate accepts its connections and those of processes that it started.
It closes others, because an agent could drive the vehicle of another one. Without `agent` all processes may connect.

## Calls
"""


def page() -> str:
    """Return the page of the gate's rules as Markdown."""
    lines = [HEAD, "| function | allowed | else |", "|---|---|---|"]
    order = list(Rule)
    for name, entry in sorted(CALLS.items(), key=lambda item: (order.index(item[1].rule), item[0])):
        lines.append(f"| `{name}` | {entry.rule.value} | {entry.why} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.exit(write_or_check(__file__, __doc__, lambda: {PAGE: page()}))
