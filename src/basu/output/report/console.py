"""The table at the end of a run, for a person's eyes."""

from __future__ import annotations

from typing import Any

from basu.output.report.measures_table import measured
from basu.output.report.passengers_table import felt
from basu.output.report.scenarios.on_way import met


def table(document: dict[str, Any]) -> str:
    """A result as lines of text."""
    lines = [f"{document['status']}: {document['message']}"]
    scores = document["scores"]
    if scores is None:
        return "\n".join([*lines, "nothing was driven, so there is no score"])
    names = {"driving": "driving score", "infraction": "  infractions", "path_following": "  path following"}
    lines += [f"{names[key]:<18}{scores[key]:8.3f}" for key in names]
    lines += [f"{name:<18}{text:>8}" for name, text in _figures(document)]
    lines += [f"  {row['t_s']:8.1f} s  {row['kind']:<21} {row['detail']}" for row in document["infractions"]]
    signs = document["stop_signs"]
    if signs:
        stopped = sum(sign["stopped"] for sign in signs)
        slowest = max(sign["lowest_speed_mps"] for sign in signs)
        lines.append(f"stop signs        {stopped} of {len(signs)} stopped at, highest lowest speed {slowest:.3f} m/s")
    stops = document["stops"]
    if stops:
        lines.append(f"service stops     {sum(stop['served'] for stop in stops)} of {len(stops)} served")
    return "\n".join([*lines, *measured(document), *felt(document), *met(document.get("scenarios", ()))])


def _figures(document: dict[str, Any]) -> list[tuple[str, str]]:
    """The figures below the scores."""
    reported, meta = document["reported"], document["meta"]
    return [
        ("infractions", str(len(document["infractions"]))),
        ("lane invasions", f"{reported['lane_invasions']['total']} (reported, not scored)"),
        ("driven", f"{reported['driven_m'] / 1000.0:.3f} km of {reported['planned_m'] / 1000.0:.3f} km"),
        ("simulated", f"{meta['simulated_s']:.1f} s in {meta['wall_s']:.1f} s of wall time{_pace(meta)}"),
    ]


def _pace(meta: dict[str, Any]) -> str:
    """How many times as fast as real time it went; nothing for a run that was over at once."""
    return f", {meta['simulated_s'] / meta['wall_s']:.2f}x real time" if meta["wall_s"] > 0.0 else ""
