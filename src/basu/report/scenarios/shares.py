"""The shares of the national crash toll that passed situations stand for, with what is assumed; as text."""

from __future__ import annotations

import textwrap
from typing import Any

WIDTH, NAME_WIDTH, AGENT_WIDTH = 110, 46, 14
SHARES = {
    "share_of_cost": "crash cost",
    "share_of_crashes": "crashes",
    "share_of_fatal_crashes": "fatal crashes",
    "share_of_equivalent_lives": "equivalent lives",
}


def shares_text(matrix: dict[str, Any]) -> str:
    """A table of the shares, an agent a column, and the assumptions; nothing where no group was measured."""
    shares = {agent: matrix["shares"][agent] for agent in matrix["agents"] if agent in matrix["shares"]}
    if all(share["share_of_cost"] is None for share in shares.values()):
        return ""
    agents = list(shares)
    room = (WIDTH - NAME_WIDTH) // AGENT_WIDTH
    tables = [_table({agent: shares[agent] for agent in agents[at : at + room]}) for at in range(0, len(agents), room)]
    lines = ["assumed:"]
    for assumption in assumptions(matrix):
        lines.append(textwrap.fill(assumption, WIDTH, initial_indent="  - ", subsequent_indent="    "))
    return "\n".join(["\n\n".join(tables), *lines])


def assumptions(matrix: dict[str, Any]) -> list[str]:
    """What the shares assume, each sentence once."""
    return list(dict.fromkeys(text for share in matrix["shares"].values() for text in share["assumptions"]))


def percent_of(share: float | None) -> str:
    """A share as people read it."""
    return "-" if share is None else f"{100.0 * share:.0f} %"


def _table(shares: dict[str, dict[str, Any]]) -> str:
    """Some agents beside each other."""
    lines = [_line("passed situations stand for this share of the", [agent[: AGENT_WIDTH - 1] for agent in shares])]
    for key, name in SHARES.items():
        lines.append(_line(f"  {name}", [percent_of(share[key]) for share in shares.values()]))
    lines.append(
        _line("of the groups measured, whose cost is", [percent_of(s["measured_of_cost"]) for s in shares.values()])
    )
    missing = {agent: ", ".join(share["unmeasured"]) for agent, share in shares.items() if share["unmeasured"]}
    for text in dict.fromkeys(missing.values()):
        lines.append(textwrap.fill(f"not measured: {text}", WIDTH, initial_indent="  ", subsequent_indent="  "))
    return "\n".join(lines)


def _line(name: str, cells: list[str]) -> str:
    return f"{name:<{NAME_WIDTH}}" + "".join(f"{cell:>{AGENT_WIDTH}}" for cell in cells)
