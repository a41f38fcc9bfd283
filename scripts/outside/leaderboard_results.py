"""Let the leaderboard's own program read a result file of ours, compute its totals again, and say whether they agree.

    python scripts/outside/leaderboard_results.py LEADERBOARD SCENARIO_RUNNER FILE.json [FILE.json ...]

The first two are checkouts of carla-simulator/leaderboard and carla-simulator/scenario_runner, branch leaderboard-2.0.
Its ``dictor`` is replaced here by a function of the same answers; nothing of the program is changed. The records are
read with ``StatisticsManager.add_file_records``, sorted, summed by ``compute_global_statistics`` and checked by
``validate_and_write_statistics``, as its ``merge_statistics.py`` does. The exit code is 0 where every value agrees.
"""

import json
import sys
import tempfile
import types
from pathlib import Path
from typing import Any


def looked_up(document: Any, path: str) -> Any:  # noqa: ANN401 - JSON
    """Return what stands at a dotted path in nested dicts; None where nothing does."""
    for part in path.split("."):
        document = document.get(part) if isinstance(document, dict) else None
    return document


def recomputed(path: Path) -> dict[str, Any]:
    """Return the file as the leaderboard's program writes it from our records."""
    from leaderboard.utils.statistics_manager import StatisticsManager  # noqa: PLC0415 - of the checkout

    ours = json.loads(path.read_text())
    with tempfile.TemporaryDirectory() as folder:
        endpoint = Path(folder) / "merged.json"
        manager = StatisticsManager(str(endpoint), "")
        manager.add_file_records(str(path))
        manager.sort_records()
        manager.save_sensors(ours["sensors"])
        count = len(ours["_checkpoint"]["records"])
        manager.save_progress(count, count)
        manager.save_entry_status("Started")
        manager.compute_global_statistics()
        manager.validate_and_write_statistics(bool(ours["sensors"]), False)
        found: dict[str, Any] = json.loads(endpoint.read_text())
    return found


def differences(ours: Any, theirs: Any, where: str = "") -> list[str]:  # noqa: ANN401 - JSON
    """Return where two documents differ: keys, types of values, and numbers by more than 1e-9."""
    if isinstance(ours, dict) and isinstance(theirs, dict):
        found = [f"{where}: keys {sorted(set(ours) ^ set(theirs))}"] if set(ours) != set(theirs) else []
        return found + [
            line for key in set(ours) & set(theirs) for line in differences(ours[key], theirs[key], f"{where}.{key}")
        ]
    if isinstance(ours, list) and isinstance(theirs, list) and len(ours) == len(theirs):
        return [
            line
            for n, (a, b) in enumerate(zip(ours, theirs, strict=True))
            for line in differences(a, b, f"{where}[{n}]")
        ]
    if isinstance(ours, int | float) and isinstance(theirs, int | float) and abs(ours - theirs) < 1e-9:
        return []
    return [] if ours == theirs else [f"{where}: {ours!r} here, {theirs!r} there"]


def main() -> int:
    """Compare each result file with the public statistics manager; return 1 if a value differs."""
    leaderboard, scenario_runner, *files = sys.argv[1:]
    sys.path[:0] = [leaderboard, scenario_runner]
    sys.modules["dictor"] = types.SimpleNamespace(dictor=looked_up)  # type: ignore[assignment]
    worst = 0
    for name in files:
        found = differences(json.loads(Path(name).read_text()), recomputed(Path(name)))
        print(f"{name}: {'agrees' if not found else f'{len(found)} differences'}", *found, sep="\n  ")
        worst = max(worst, int(bool(found)))
    return worst


if __name__ == "__main__":
    sys.exit(main())
