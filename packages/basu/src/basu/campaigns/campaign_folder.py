"""The folder of a campaign: its file names, its lock, and `campaign.json`, written at the start, compared on resume."""

from __future__ import annotations

import contextlib
import fcntl
import json
import os
import shutil
from typing import TYPE_CHECKING, Any

from basu.campaigns.plan import CampaignPlan
from basu.errors import UserError
from basu.files import read_json
from basu.output.report.documents import write_json
from basu.running.series import changes

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

CAMPAIGN_FILE, PROGRESS_FILE, STOP_FILE, LOCK_FILE, SCRATCH = (
    "campaign.json",
    "progress.json",
    "stopped.json",
    ".lock",
    "scratch",
)
SCHEMA_VERSION = 1


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold the lock of a folder; the system releases it when this process ends, however that goes.

    Folders that were made for the lock go again where nothing was written into them: the campaign was refused.

    Raises:
        UserError: another command holds it, or the folder cannot be made.
    """
    made = [each for each in (folder, *folder.parents) if not each.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(folder / LOCK_FILE, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
    except OSError as error:
        raise UserError(f"{folder} cannot be used: {error.strerror}; name another place with --output") from error
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if os.fstat(descriptor).st_nlink == 0:  # a command that was refused has removed it since it was opened
            raise BlockingIOError
    except OSError:
        os.close(descriptor)
        raise UserError(
            f"another command drives the campaign in {folder} now; wait for it, or name another place with --output"
        ) from None
    try:
        yield
    finally:
        if made and [path.name for path in folder.iterdir()] == [LOCK_FILE]:
            _remove(folder / LOCK_FILE, made)
        os.close(descriptor)


def _remove(lock: Path, folders: list[Path]) -> None:
    """Remove the lock and the folders around it that hold nothing else, the innermost first."""
    with contextlib.suppress(OSError):  # another command has begun to use one of them
        lock.unlink()
        for folder in folders:
            folder.rmdir()


def is_locked(folder: Path) -> bool:
    """Whether a command drives the campaign now."""
    try:
        descriptor = os.open(folder / LOCK_FILE, os.O_RDONLY | os.O_CLOEXEC)
    except OSError:
        return False
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError:
        return True
    else:
        return False
    finally:
        os.close(descriptor)


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
        raise UserError(f"{path} has the schema version {found!r}, and this version of basu reads {SCHEMA_VERSION}")
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
