"""What was measured beside the score, as lines of the console's table: what did not happen takes no line."""

from __future__ import annotations

from typing import Any

SHARES = {"route_deviation": "outside the plan", "outside_lanes": "outside lanes", "wrong_way": "wrong way"}


def measured(document: dict[str, Any]) -> list[str]:
    """The lines for lights, lanes, takeovers and the leaderboard's scores."""
    lines = []
    lights = document["red_lights"]
    if lights:
        lines.append(f"traffic lights    {sum(light['run'] for light in lights)} of {len(lights)} run on red")
    for key, name in SHARES.items():
        found = document[key]
        if found["metres"] > 0.0:
            lines.append(f"{name:<18}{found['metres']:.1f} m, {100.0 * found['share']:.1f} % of the way (not scored)")
    takeovers = document["disengagements"]
    if takeovers["number"]:
        miles = takeovers["miles_per_disengagement"]
        lines.append(f"disengagements    {takeovers['number']}, {miles:.2f} miles by the agent to each")
    return [*lines, *(_leaderboard(version, scores) for version, scores in document["leaderboard"].items())]


def _leaderboard(version: str, scores: dict[str, Any]) -> str:
    """The line of one version."""
    ended = f", ended by {scores['ended_by']}" if scores["ended_by"] is not None else ""
    return (
        f"leaderboard {version}   {scores['driving']:.2f} = {scores['route_completion']:.2f} % of the route "
        f"x {scores['infraction_penalty']:.3f}{ended}"
    )
