"""The shares of crash cost that passed situations stand for, with intervals and what is assumed; as text."""

from __future__ import annotations

import textwrap
from typing import Any

from basu.scenarios.shares import CONTROL_DRIVERS

WIDTH, NAME_WIDTH, AGENT_WIDTH = 110, 34, 15
LEAST_GROUPS = 2
SHARES = {
    "share_of_cost": "crash cost",
    "share_of_crashes": "crashes",
    "share_of_fatal_crashes": "fatal crashes",
    "share_of_equivalent_lives": "equivalent lives",
}
BASELINE = (
    "add --agent blind --agent creeper --agent standing for the baseline: what a driver reaches without judgement."
)


def shares_text(matrix: dict[str, Any]) -> str:
    """A table of the shares, an agent a column, and the assumptions; nothing where there is nothing to weigh."""
    if not is_weighed(matrix):
        return ""
    agents = controls_last(matrix["agents"])
    room = (WIDTH - NAME_WIDTH) // AGENT_WIDTH
    shares = matrix["shares"]
    tables = [_table({agent: shares[agent] for agent in agents[at : at + room]}) for at in range(0, len(agents), room)]
    notes = [textwrap.fill(text, WIDTH) for text in control_notes(agents)]
    assumed = [
        textwrap.fill(text, WIDTH, initial_indent="  - ", subsequent_indent="    ") for text in assumptions(matrix)
    ]
    return "\n".join(["\n\n".join(tables), *notes, "assumed:", *assumed])


def is_weighed(matrix: dict[str, Any]) -> bool:
    """Whether shares say more than the table does: at least two groups of the typology were played."""
    counts = [sum(group["burden"] is not None for group in share["groups"]) for share in matrix["shares"].values()]
    return max(counts, default=0) >= LEAST_GROUPS


def assumptions(matrix: dict[str, Any]) -> list[str]:
    """What the shares assume, each sentence once."""
    return list(dict.fromkeys(text for share in matrix["shares"].values() for text in share["assumptions"]))


def controls_last(agents: list[str]) -> list[str]:
    """The agents, control drivers behind the rest."""
    return sorted(agents, key=lambda agent: agent in CONTROL_DRIVERS)


def control_notes(agents: list[str]) -> list[str]:
    """What the control drivers are, or how to add them."""
    played = [f"{agent} {CONTROL_DRIVERS[agent]}" for agent in agents if agent in CONTROL_DRIVERS]
    return [f"control drivers: {', '.join(played)}."] if played else [BASELINE]


def percent_of(share: float | None) -> str:
    """A share as people read it."""
    return "-" if share is None else f"{100.0 * share:.0f} %"


def interval(estimate: dict[str, float] | None) -> str:
    """A share with its interval of 95 %."""
    if estimate is None:
        return "-"
    return f"{percent_of(estimate['share'])} ({100.0 * estimate['low']:.0f}-{100.0 * estimate['high']:.0f})"


def _table(shares: dict[str, dict[str, Any]]) -> str:
    """Some agents beside each other."""
    lines = [_line("of the exercised, passed (95 %)", [agent[: AGENT_WIDTH - 1] for agent in shares])]
    lines += [_line(f"  {name}", [interval(share[key]) for share in shares.values()]) for key, name in SHARES.items()]
    measured = [percent_of(share["measured_of_cost"]) for share in shares.values()]
    lines.append(_line("  groups' part of all cost", measured))
    lines.append(_line("shown of all crash cost", [interval(share["shown_of_cost"]) for share in shares.values()]))
    lines.append(_line("cases not exercised", [str(share["not_exercised"]) for share in shares.values()]))
    lines.append(_line("collisions, at fault", [f"{s['collisions']}, {s['at_fault']}" for s in shares.values()]))
    missing: dict[str, list[str]] = {}
    for agent, share in shares.items():
        if share["unmeasured"]:
            missing.setdefault(", ".join(share["unmeasured"]), []).append(agent)
    for names, agents in missing.items():
        text = f"not exercised by {', '.join(agents)}: {names}"
        lines.append(textwrap.fill(text, WIDTH, initial_indent="  ", subsequent_indent="    "))
    return "\n".join(lines)


def _line(name: str, cells: list[str]) -> str:
    """A row of the table."""
    return f"{name:<{NAME_WIDTH}}" + "".join(f"{cell:>{AGENT_WIDTH}}" for cell in cells)
