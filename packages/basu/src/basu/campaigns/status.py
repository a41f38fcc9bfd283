"""``basu campaign status``: how far a campaign has come, from another shell."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from basu.campaigns.campaign_folder import PROGRESS_FILE, STOP_FILE, read_campaign_document
from basu.campaigns.drive_table import DRIVES, journal_rows, open_drives
from basu.campaigns.evidence import AgentEvidence
from basu.files import read_json
from basu.intervals import wilson
from basu.running.folder_lock import is_locked

if TYPE_CHECKING:
    from pathlib import Path


def status(folder: Path) -> str:
    """The state of a campaign in lines: drives done, success of each agent, faults, and the time left.

    Raises:
        UserError: it is no folder of a campaign.
    """
    document = read_campaign_document(folder)
    rows = _rows(folder)
    counts: Counter[tuple[str, str]] = Counter()
    evidence = AgentEvidence()
    for row in rows.values():
        evidence.add(row)
        counts[row["agent"], "all"] += 1
        counts[row["agent"], "judged"] += bool(row["judged"])
        counts[row["agent"], row["fault"]] += 1
        counts[row["agent"], "not exercised"] += row.get("not_exercised") or 0
    planned = document["planned"]
    width = max(8, *(len(agent) for agent in document["agents"]))
    lines = [f"campaign  {document['name']}", f"state     {_state(folder, len(rows), planned)}"]
    lines.append(f"drives    {len(rows)} of {planned}")
    for agent in document["agents"]:
        distinct, successes = evidence.of(agent)
        known = wilson(successes, distinct, document["settings"]["confidence"])
        broken = sum(counts[agent, fault] for fault in ("simulator", "setup", "benchmark"))
        rate = f"{100.0 * known.value:.1f} % success ({100.0 * known.low:.1f} to {100.0 * known.high:.1f})"
        repeated = counts[agent, "judged"] - distinct
        rate += f", {repeated} repeat another drive under a new seed and do not count" if repeated else ""
        said = rate if distinct else "nothing judged yet"
        faults = f", {broken} with a fault that is not the agent's" if broken else ""
        absent = f", {counts[agent, 'not exercised']} not exercised"
        lines.append(f"{agent:<{width}}  {counts[agent, 'all']} drives, {said}{absent}{faults}")
    return "\n".join(lines)


def _rows(folder: Path) -> dict[int, dict[str, Any]]:
    """The rows by number, as far as they are written."""
    rows: dict[int, dict[str, Any]] = {}
    if any((folder / DRIVES).glob("*/block-*.parquet")):
        for batch in open_drives(folder).to_batches():
            rows |= {row["number"]: row for row in batch.to_pylist()}
    for row in journal_rows(folder):
        rows[row["number"]] = row
    return rows


def _state(folder: Path, done: int, planned: int) -> str:
    """What happens now, and the time left where drives go on."""
    if (folder / STOP_FILE).exists():
        return "finished: the question is answered"
    if done >= planned:
        return "finished"
    if not is_locked(folder):
        return "stopped; `basu campaign run FILE --resume` goes on with it"
    path = folder / PROGRESS_FILE
    found = read_json(path, "the progress") if path.exists() else {"driven_by_this_command": 0, "wall_s": 0.0}
    if not found["driven_by_this_command"]:
        return "running"
    rate = found["driven_by_this_command"] / found["wall_s"]
    return f"running, {rate:.2f} drives/s, about {_time((planned - done) / rate)} left"


def _time(seconds: float) -> str:
    """A time for people."""
    minutes = round(seconds / 60.0)
    return f"{round(seconds)} s" if seconds < 120.0 else f"{minutes // 60} h {minutes % 60} min"
