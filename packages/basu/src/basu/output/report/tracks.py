"""The tracks of runs in reports: their names, groups of one track, and the sentence that keeps groups apart.

A run without a gate is in a group of its own: its agent could read and change everything.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

UNKNOWN = ""  # of a run that no agent of BASU's commands drove, or that an older version drove
NO_GATE = "no gate stood between the agent and the simulator (--open, or --in-process with an agent of a user)"

ON_OWN_ROUTE = "the route was the agent's own, and not the benchmark's"


def track_of(access: Mapping[str, Any] | None) -> str:
    """Return the track of a run as tables name it, with a mark where no gate stood before the agent."""
    if not access:
        return UNKNOWN
    track = str(access["track"])
    return f"{track}, NOT COMPARABLE: open" if access["open"] else track


def tracks_of(accesses: Iterable[Mapping[str, Any] | None]) -> str:
    """Return the track of an agent's drives; several, with "and" between them, if they were driven differently."""
    return " and ".join(sorted({track_of(access) for access in accesses} - {UNKNOWN}))


def titled(track: str) -> str:
    """Return a heading for a group of one track."""
    return f"track {track}" if track else "track not recorded"


def grouped(names: Sequence[str], tracks: Mapping[str, str]) -> dict[str, list[str]]:
    """Return the names of agents by track, in the order in which the tracks first occur."""
    groups: dict[str, list[str]] = {}
    for name in names:
        groups.setdefault(tracks.get(name, UNKNOWN), []).append(name)
    return groups


def apart(names: Sequence[str], tracks: Mapping[str, str]) -> str:
    """Return the sentence that names the tracks and keeps their scores apart; empty where there is one track."""
    groups = grouped(names, tracks)
    if len(groups) < 2:
        return ""
    named = "; ".join(f"{titled(track)}: {', '.join(group)}" for track, group in groups.items())
    return (
        f"These agents learned different things of others, so each track has a table of its own and no score is "
        f"compared across tracks ({named})."
    )
