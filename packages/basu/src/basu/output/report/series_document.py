"""``series.json``: many runs of one command as rows and totals, complete after each of them."""

from __future__ import annotations

import statistics
from collections import Counter
from typing import TYPE_CHECKING, Any

from basu.metrics.leaderboard.scores import COMPARED
from basu.output.report.document_parts import SeriesRow
from basu.output.report.drive_row import part_of, row_of
from basu.output.report.event_rates import rate_text
from basu.output.report.tracks import ON_OWN_ROUTE

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.metrics.result import Result

SCORES = ("driving", "infraction", "path_following")
PASSED = {"passed": True, "failed": False, "not judged": None}  # by the one rule of success
NAMES = {"driving": "driving score", "infraction": "  infractions", "path_following": "  path following"}


def row(result: Result, *, number: int, repetition: int, folder: str) -> dict[str, Any]:
    """Return what a series keeps of a run's result."""
    return part_of({**row_of(result), "number": number, "repetition": repetition, "folder": folder}, SeriesRow)


def totals(rows: Sequence[Mapping[str, Any]], planned: int) -> dict[str, Any]:
    """Means, deviations and counts over the runs that are done, as in the leaderboard's global record.

    A run without a score (nothing was driven) counts as 0 in the means. The leaderboard divides by the runs that were
    planned; here the means are those of the runs that are done, and ``done`` says how many that is.
    """
    kinds: Counter[str] = Counter()
    for each in rows:
        kinds.update(each["infractions"])
    driven_km = sum(each["driven_m"] for each in rows) / 1000.0
    versions = sorted({version for each in rows for version in each["leaderboard"]})
    return {
        "done": len(rows),
        "planned": planned,
        "scores": {name: _spread([(each["scores"] or {}).get(name, 0.0) for each in rows]) for name in SCORES},
        "leaderboard": {
            version: {
                name: _spread([each["leaderboard"].get(version, {}).get(name, 0.0) for each in rows])
                for name in COMPARED
            }
            for version in versions
        },
        "passed": {word: sum(each.get("passed") is value for each in rows) for word, value in PASSED.items()},
        "statuses": dict(sorted(Counter(each["status"] for each in rows).items())),
        "infractions": {
            kind: {"number": kinds[kind], "per_km": kinds[kind] / driven_km if driven_km > 0.0 else None}
            for kind in sorted(kinds)
        },
        "driven_km": driven_km,
        "simulated_s": sum(each["simulated_s"] for each in rows),
        "wall_s": round(sum(each["wall_s"] for each in rows), 3),
    }


def series_table(name: str, document: Mapping[str, Any]) -> str:
    """Return a series as lines of text."""
    total = document["totals"]
    lines = [f"series {name}: {total['done']} of {total['planned']} runs done"]
    if not total["done"]:
        return lines[0]
    tracks = Counter(each["track"] for each in document["runs"] if each.get("track"))
    if len(tracks) > 1:
        shares = "; ".join(f"{count} in the track {track}" for track, count in tracks.items())
        return "\n".join([*lines, f"no means: scores of different tracks are not averaged ({shares})"])
    lines += [f"{'track':<18}{track}" for track in tracks]
    lines.append(f"{'':<26}  mean   +/-    lowest highest")
    lines += [_line(NAMES[key], total["scores"][key]) for key in SCORES]
    lines += [
        _line(f"leaderboard {version}", scores["driving"]) for version, scores in sorted(total["leaderboard"].items())
    ]
    own = sum(bool(each.get("own_route")) for each in document["runs"])
    if own:
        lines.append(f"{'NOT COMPARABLE':<18}{ON_OWN_ROUTE} in {own} of {total['done']} runs")
    judged = {word: count for word, count in total.get("passed", {}).items() if count}
    lines += [f"{'result':<18}{', '.join(f'{count} {word}' for word, count in judged.items())}"] if judged else []
    lines.append(f"{'ended':<18}{', '.join(f'{count} {status}' for status, count in total['statuses'].items())}")
    driven_m = 1000.0 * total["driven_km"]
    counts = {kind: found["number"] for kind, found in total["infractions"].items()}
    lines += [f"{kind:<26}{rate_text(number, driven_m)}" for kind, number in counts.items()]
    lines.append(f"{'all infractions':<26}{rate_text(sum(counts.values()), driven_m)}")
    pace = f", {total['simulated_s'] / total['wall_s']:.2f}x real time" if total["wall_s"] > 0.0 else ""
    lines.append(
        f"driven            {total['driven_km']:.3f} km, {total['simulated_s']:.1f} s simulated in "
        f"{total['wall_s']:.1f} s of wall time{pace}"
    )
    return "\n".join(lines)


def _spread(values: Sequence[float]) -> dict[str, float]:
    """Mean, standard deviation of the sample, extremes; zeros where there is nothing."""
    return {
        "mean": statistics.fmean(values) if values else 0.0,
        "deviation": statistics.stdev(values) if len(values) > 1 else 0.0,
        "lowest": min(values, default=0.0),
        "highest": max(values, default=0.0),
    }


def _line(name: str, spread: Mapping[str, float]) -> str:
    figures = "".join(f"{spread[key]:8.3f}" for key in ("mean", "deviation", "lowest", "highest"))
    return f"{name:<22}{figures}"
