"""The folder of a campaign: its file names, and `campaign.json`, written at the start, compared on resume."""

from __future__ import annotations

import json
import shutil
from typing import TYPE_CHECKING, Any

from basu.campaigns.plan import CampaignPlan
from basu.errors import UserError
from basu.files import other_version, read_json
from basu.output.report.documents import write_json
from basu.running.batch import changes

if TYPE_CHECKING:
    from pathlib import Path

CAMPAIGN_FILE, PROGRESS_FILE, STOP_FILE, SCRATCH = "campaign.json", "progress.json", "stopped.json", "scratch"
SCHEMA_VERSION = 1


def begin(folder: Path, plan: CampaignPlan, source: Path, *, resume: bool) -> None:
    """Write the document of a new campaign, or compare that of one that goes on.

    Raises:
        UserError: there is a campaign already, or none to go on with, or one that was begun differently.
    """
    path = folder / CAMPAIGN_FILE
    identity = json.loads(json.dumps(plan.identity()))
    if resume and not path.exists():
        raise UserError(f"there is no campaign in {folder} to go on with; run without --resume to begin it")
    if not resume and path.exists():
        raise UserError(
            f"{folder} holds a campaign already; add --resume to go on with it, or name another place with --output"
        )
    if resume:
        _compare(read_campaign_document(folder)["identity"], identity, folder)
        shutil.rmtree(folder / SCRATCH, ignore_errors=True)
    else:
        document = {
            "schema_version": SCHEMA_VERSION,
            "name": plan.campaign.name,
            "file": source.name,
            "settings": plan.campaign.model_dump(mode="json", by_alias=True),
            "agents": [agent.name for agent in plan.agents],
            "tracks": {agent.name: agent.group for agent in plan.agents},
            "planned": plan.size,
            "identity": identity,
        }
        write_json(path, document)
    try:
        (folder / SCRATCH).mkdir(exist_ok=True)
    except OSError as error:
        raise UserError(f"{folder / SCRATCH} could not be made: {error.strerror}; make room") from error


def read_campaign_document(folder: Path) -> dict[str, Any]:
    """``campaign.json`` of a folder.

    Raises:
        UserError: there is none, or another version wrote it.
    """
    path = folder / CAMPAIGN_FILE
    if not path.exists():
        raise UserError(f"{folder} is no folder of a campaign; name one that `basu campaign run` has left")
    document = read_json(path, "the campaign's document")
    found = document.get("schema_version") if isinstance(document, dict) else None
    if found != SCHEMA_VERSION:
        raise other_version(path, found, SCHEMA_VERSION)
    return dict(document)


def _compare(before: dict[str, Any], now: dict[str, Any], folder: Path) -> None:
    """Refuse to go on under other conditions.

    Raises:
        UserError: names what is different.
    """
    changed = changes(before, now, shown=_short)
    if changed:
        raise UserError(
            f"the campaign in {folder} was begun differently: {changed}; go on with the file and versions "
            "that it was begun with, or begin another with --output"
        )


def _short(value: object) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 80 else f"{text[:77]}..."
