"""The scenarios that a run met on the way of its route, on the console."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.output.report.scenarios.verdicts import LOOKS

if TYPE_CHECKING:
    from collections.abc import Sequence

NOT_REACHED = "not reached"


def met(scenarios: Sequence[dict[str, Any]]) -> list[str]:
    """A line for all of them, and one for each: when, which, the verdict, and why."""
    if not scenarios:
        return []
    reached = [row for row in scenarios if row["reached"]]
    passed = sum(row["verdict"] == "SUCCESS" for row in scenarios)
    judged = sum(row["verdict"] is not None and LOOKS[row["verdict"]].is_judged for row in scenarios)
    lines = [f"scenarios         {passed} of {judged} passed; {len(reached)} of {len(scenarios)} reached"]
    return [*lines, *(_line(row) for row in scenarios)]


def verdict_word(row: dict[str, Any]) -> str:
    """The verdict of a scenario in a word or two."""
    return NOT_REACHED if row["verdict"] is None else LOOKS[row["verdict"]].word


def _line(row: dict[str, Any]) -> str:
    """One scenario."""
    when = f"{row['began_s']:8.1f} s" if row["began_s"] is not None else " " * 10
    return f"  {when}  {verdict_word(row):<21} {row['id']} ({row['scenario']}): {row['message']}"
