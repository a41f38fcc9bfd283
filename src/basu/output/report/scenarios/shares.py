"""The shares of the national crash toll that passed situations stand for, with what is assumed; as text."""

from __future__ import annotations

import textwrap
from typing import Any

WIDTH, NAME_WIDTH, AGENT_WIDTH = 110, 46, 14
LEAST_GROUPS = 2
SHARES = {
    "share_of_cost": "crash cost",
    "share_of_crashes": "crashes",
    "share_of_fatal_crashes": "fatal crashes",
    "share_of_equivalent_lives": "equivalent lives",
}


def shares_text(matrix: dict[str, Any]) -> str:
    """A table of the shares, an agent a column, and the assumptions; nothing where there is nothing to weigh."""
    if not is_weighed(matrix):
        return ""
    shares = {agent: matrix["shares"][agent] for agent in matrix["agents"]}
    agents = list(shares)
    room = (WIDTH - NAME_WIDTH) // AGENT_WIDTH
    tables = [_table({agent: shares[agent] for agent in agents[at : at + room]}) for at in range(0, len(agents), room)]
    assumed = [
        textwrap.fill(text, WIDTH, initial_indent="  - ", subsequent_indent="    ") for text in assumptions(matrix)
    ]
    return "\n".join(["\n\n".join(tables), "assumed:", *assumed])


def is_weighed(matrix: dict[str, Any]) -> bool:
    """Whether shares say more than the table does: at least two groups of the typology were measured."""
    tolls = [sum(group["toll"] is not None for group in share["groups"]) for share in matrix["shares"].values()]
    return max(tolls, default=0) >= LEAST_GROUPS


def assumptions(matrix: dict[str, Any]) -> list[str]:
    """What the shares assume, each sentence once."""
    return list(dict.fromkeys(text for share in matrix["shares"].values() for text in share["assumptions"]))


def percent_of(share: float | None) -> str:
    """A share as people read it."""
    return "-" if share is None else f"{100.0 * share:.0f} %"


def _table(shares: dict[str, dict[str, Any]]) -> str:
    """Some agents beside each other."""
    lines = [_line("passed situations stand for this share of the", [agent[: AGENT_WIDTH - 1] for agent in shares])]
    lines += [_line(f"  {name}", [percent_of(share[key]) for share in shares.values()]) for key, name in SHARES.items()]
    measured = [percent_of(share["measured_of_cost"]) for share in shares.values()]
    lines.append(_line("of the groups measured, which make of all cost", measured))
    missing = dict.fromkeys(", ".join(share["unmeasured"]) for share in shares.values() if share["unmeasured"])
    lines += [textwrap.indent(textwrap.fill(f"not measured: {names}", WIDTH - 2), "  ") for names in missing]
    return "\n".join(lines)


def _line(name: str, cells: list[str]) -> str:
    """A row of the table."""
    return f"{name:<{NAME_WIDTH}}" + "".join(f"{cell:>{AGENT_WIDTH}}" for cell in cells)
