"""The cases of a campaign as its risk for a million miles counts them: how each ended, and with which weight.

A drive of an estimate counts with its importance weight. A drive that only moved an estimate's proposal does not count.
Neither does a drive of a search: the search chooses it at the boundary of failure, so it is no sample of the case.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.campaigns.campaign_folder import read_campaign_document
from basu.campaigns.drive_table import open_drives, read_drives
from basu.campaigns.search_part import SEARCH, DriveWeight, search_plugin
from basu.errors import UserError
from basu.records.partners import Partner
from basu.scenarios.nhtsa import Group
from basu.scenarios.risk.estimate import PlayedCase
from basu.scenarios.shares import CountedCase
from basu.scenarios.verdict import Verdict

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

COLUMNS = [
    "number",
    "agent",
    "kind",
    "subject",
    "fault",
    "success",
    "not_exercised",
    "message",
    "collisions_number",
    "collisions_at_fault",
    "completed",
    "impact_mps",
    "scenario",
    "group",
    "pre_crash",
    "partner",
    "passengers_largest_braking_mps2",
]
FAULTS = {
    "simulator": Verdict.SIMULATOR_FAULT,
    "setup": Verdict.SETUP_FAULT,
    "benchmark": Verdict.BENCHMARK_FAULT,
    "agent": Verdict.AGENT_FAULT,
}


def played_in(folder: Path) -> dict[str, list[PlayedCase]]:
    """Return the cases that each agent of a campaign has driven, by its name; drives on routes are left out.

    Raises:
        UserError: it is no folder of a campaign, or an earlier version drove it.
        UserError: no drive in it is a sample of a case, or the plugin of its estimates is not installed.
    """
    agents: list[str] = read_campaign_document(folder)["agents"]
    missing = [name for name in COLUMNS if name not in open_drives(folder).schema.names]
    if missing:
        raise UserError(
            f"the drives of {folder} have no column '{missing[0]}', since an earlier version drove them; drive the "
            "campaign again with `basu campaign run FILE`"
        )
    rows = read_drives(folder, COLUMNS).to_pylist()
    weights = search_plugin().weights(folder, read_drives(folder)) if (folder / SEARCH).is_dir() else {}
    found: dict[str, list[PlayedCase]] = {agent: [] for agent in agents}
    for row in rows:
        weight = weights.get(row["number"], DriveWeight())
        if row["kind"] == "case" and row["scenario"] is not None and weight is not None:
            found[row["agent"]].append(_played(row, weight))
    if not any(found.values()):
        raise UserError(
            f"no drive of {folder} is a sample of a case: risk needs [[drives]] with cases, and with a sweep, a grid "
            "or an estimate; a search chooses its drives at the boundary of failure"
        )
    return found


def _played(row: Mapping[str, Any], weight: DriveWeight) -> PlayedCase:
    """Return a row as a case."""
    counted = CountedCase(
        case=row["subject"],
        scenario=row["scenario"],
        group=Group(row["group"]),
        verdict=_verdict(row),
        message=row["message"],
        margins={},
        at_fault=row["collisions_at_fault"] or 0,
        collisions=row["collisions_number"] or 0,
        pre_crash=tuple(int(number) for number in row["pre_crash"].split()),
    )
    return PlayedCase(
        counted=counted,
        completed=bool(row["completed"]),
        partner=Partner(row["partner"]),
        impact_mps=row["impact_mps"],
        braking_mps2=row["passengers_largest_braking_mps2"] or 0.0,
        weight=weight.weight,
        plain=weight.plain,
    )


def _verdict(row: Mapping[str, Any]) -> Verdict:
    """Return the verdict of a row."""
    if row["fault"] in FAULTS:
        return FAULTS[row["fault"]]
    if row["success"] is None:
        return Verdict.NOT_EXERCISED if row["not_exercised"] else Verdict.INTERRUPTED
    return Verdict.SUCCESS if row["success"] else Verdict.FAILURE
