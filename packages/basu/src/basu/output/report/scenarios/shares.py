"""The crash cost that passed cases stand for, with intervals and assumptions: as text and as bars."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

from basu.intervals import FEW
from basu.output.report.scenarios.tally import tracks
from basu.output.report.templates import render
from basu.output.report.tracks import grouped, titled
from basu.scenarios.shares import CONTROL_DRIVERS

if TYPE_CHECKING:
    from markupsafe import Markup


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
    """Return a table of the shares, an agent a column, and the assumptions; nothing where there is nothing to weigh."""
    if not is_weighed(matrix):
        return ""
    agents = controls_last(matrix["agents"])
    room = (WIDTH - NAME_WIDTH) // AGENT_WIDTH
    shares = matrix["shares"]
    groups = grouped(agents, tracks(matrix))
    tables = [
        _table({agent: shares[agent] for agent in group[at : at + room]}, titled(track) if len(groups) > 1 else "")
        for track, group in groups.items()
        for at in range(0, len(group), room)
    ]
    notes = [textwrap.fill(text, WIDTH) for text in control_notes(agents)]
    assumed = [
        textwrap.fill(text, WIDTH, initial_indent="  - ", subsequent_indent="    ") for text in assumptions(matrix)
    ]
    return "\n".join(["\n\n".join(tables), *notes, "assumed:", *assumed])


def is_weighed(matrix: dict[str, Any]) -> bool:
    """Return whether shares say more than the table does: at least two groups of the typology were played."""
    counts = [sum(group["burden"] is not None for group in share["groups"]) for share in matrix["shares"].values()]
    return max(counts, default=0) >= LEAST_GROUPS


def assumptions(matrix: dict[str, Any]) -> list[str]:
    """Return what the shares assume, each sentence once."""
    return list(dict.fromkeys(text for share in matrix["shares"].values() for text in share["assumptions"]))


def controls_last(agents: list[str]) -> list[str]:
    """Return the agents, control drivers behind the rest."""
    return sorted(agents, key=lambda agent: agent in CONTROL_DRIVERS)


def control_notes(agents: list[str]) -> list[str]:
    """Return what the control drivers are, or how to add them."""
    played = [f"{agent} {CONTROL_DRIVERS[agent]}" for agent in agents if agent in CONTROL_DRIVERS]
    return [f"control drivers: {', '.join(played)}."] if played else [BASELINE]


def percent_of(share: float | None) -> str:
    """Return a share as people read it."""
    return "-" if share is None else f"{100.0 * share:.0f} %"


def interval(estimate: dict[str, float] | None) -> str:
    """Return a share with its interval of 95 %."""
    if estimate is None:
        return "-"
    return f"{percent_of(estimate['share'])} ({100.0 * estimate['low']:.0f}-{100.0 * estimate['high']:.0f})"


def _table(shares: dict[str, dict[str, Any]], title: str) -> str:
    """Some agents of one track beside each other, below the title if there is one."""
    lines = [title] if title else []
    lines.append(_line("of the exercised, passed (95 %)", [agent[: AGENT_WIDTH - 1] for agent in shares]))
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
    """Return a row of the table."""
    return f"{name:<{NAME_WIDTH}}" + "".join(f"{cell:>{AGENT_WIDTH}}" for cell in cells)


MUSD_IN_BUSD = 1000.0


def shares_view(matrix: dict[str, Any]) -> Markup | None:
    """Return the section of a page; None where fewer than two groups were measured."""
    if not is_weighed(matrix):
        return None
    shares = {agent: matrix["shares"][agent] for agent in controls_last(matrix["agents"])}
    groups = grouped(list(shares), tracks(matrix))
    return render(
        "templates/shares.j2",
        control_notes=" ".join(control_notes(list(shares))),
        groups=[
            {
                "title": titled(track) if track or len(groups) > 1 else "",
                "scores": [_score(agent, shares[agent]) for agent in agents],
                "rows": _group_rows({agent: shares[agent] for agent in agents}),
            }
            for track, agents in groups.items()
        ],
        assumptions=assumptions(matrix),
    )


def _score(agent: str, share: dict[str, Any]) -> dict[str, str]:
    """Return the texts of an agent's card: its shares of crash cost, in words."""
    cost = share["share_of_cost"]
    others = ", ".join(f"{interval(share[key])} of {name}" for key, name in list(SHARES.items())[1:])
    part = percent_of(share["measured_of_cost"])
    rest = "" if cost is None else f"{others}; the groups exercised make {part} of all cost. "
    return {
        "agent": agent,
        "percent": percent_of(None if cost is None else cost["share"]),
        "words": _words(cost),
        "note": f"{interval(share['shown_of_cost'])} shown of all crash cost. {rest}"
        f"{share['not_exercised']} cases not exercised; {share['collisions']} collisions, "
        f"{share['at_fault']} at fault.",
    }


def _words(cost: dict[str, float] | None) -> str:
    """Return what the figure beside an agent's name is, with its interval."""
    if cost is None:
        return "exercised no situation of the typology"
    return f"passed, of the crash cost of exercised situations ({100.0 * cost['low']:.0f}-{100.0 * cost['high']:.0f} %)"


def _group_rows(shares: dict[str, dict[str, Any]]) -> list[dict[str, Any]]:
    """Return a row for each group, with a cell for each agent."""
    burdens: dict[str, dict[str, Any] | None] = {}
    found: dict[tuple[str, str], dict[str, Any]] = {}
    for agent, share in shares.items():
        for group in share["groups"]:
            burdens[group["group"]] = group["burden"]
            found[group["group"], agent] = group
    greatest = max((burden["cost_musd"] for burden in burdens.values() if burden is not None), default=1)
    return [
        {
            "group": group,
            "cost": "weighs nothing" if burden is None else f"{burden['cost_musd'] / MUSD_IN_BUSD:.1f} bn $",
            "cells": [
                _bar(found.get((group, agent)), None if burden is None else burden["cost_musd"] / greatest)
                for agent in shares
            ],
        }
        for group, burden in burdens.items()
    ]


def _bar(group: dict[str, Any] | None, weight: float | None) -> dict[str, Any]:
    """One group with one agent: the bar's outline is the weight, the filled part what was passed."""
    if group is None:
        return {"is_weighed": False, "text": "not played"}
    passed, absent = group["passed"], group["not_exercised"]
    if passed is None:
        return {"is_weighed": False, "text": f"{absent} not exercised"}
    counts = [f"{group[key]} {key[: None if group[key] != 1 else -1]}" for key in ("cases", "scenarios")]
    known = percent_of(passed["share"]) if group["cases"] == 1 else interval(passed)
    few = f", fewer than {FEW}" if 1 < group["cases"] < FEW else ", no interval" if group["cases"] == 1 else ""
    text = f"{known} of {' of '.join(counts)}{few}" + (f", {absent} not exercised" if absent else "")
    return {"is_weighed": True, "weight": weight, "filled": passed["share"], "text": text}
