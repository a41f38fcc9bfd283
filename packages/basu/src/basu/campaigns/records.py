"""Selection and storage of drive records to keep: failures, successes with the smallest margins, and a sample."""

from __future__ import annotations

import heapq
import io
import math
import shutil
import tarfile
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.campaigns.player import is_sampled
from basu.errors import UserError
from basu.files import read_json
from basu.output.report.documents import DRAFTS, write_json

if TYPE_CHECKING:
    from pathlib import Path

    from basu.campaigns.settings import Keep

RECORDS, DRIVE_FILE = "records", "drive.json"
FAILURE, FAULT, NARROWEST, SAMPLE = "failure", "fault", "narrowest", "sample"


class Kept(NamedTuple):
    """A drive with a folder; compared by how narrow it was."""

    severity: float
    number: int
    id: str
    agent: str
    reason: str


class Records:
    """The folders below ``records`` of a campaign, one an id; holds a bounded list of them."""

    def __init__(self, folder: Path, keep: Keep) -> None:
        """Take up what earlier commands have left.

        Raises:
            UserError: a folder's document cannot be read.
        """
        self._folder, self._keep = folder / RECORDS, keep
        self._failures: dict[str, set[str]] = {}
        self._narrowest: dict[str, list[Kept]] = {}
        for draft in self._folder.glob(f"*/{DRAFTS}"):
            shutil.rmtree(draft, ignore_errors=True)
        for kept in kept_in(folder):
            self._enter(kept)

    def bar(self, agent: str) -> float:
        """The severity above which a success of the agent is worth keeping."""
        if not self._keep.narrowest:
            return math.inf
        narrowest = self._narrowest.get(agent, [])
        return narrowest[0].severity if len(narrowest) >= self._keep.narrowest else -1.0

    def offer(self, row: dict[str, Any], packed: bytes | None) -> None:
        """Write the folder of a drive where it is worth keeping, in one step.

        Raises:
            UserError: the disk is full.
        """
        reason = self._reason(row)
        if packed is None or reason is None:
            return
        kept = Kept(row["severity"], row["number"], row["id"], row["agent"], reason)
        self._unpack(kept, row, packed)
        self._enter(kept)

    def _reason(self, row: dict[str, Any]) -> str | None:
        """Why a drive is kept; None where it is not."""
        agent = row["agent"]
        if not row["success"] and row["id"] not in self._failures.get(agent, ()):
            has_room = len(self._failures.get(agent, ())) < self._keep.failures
            return (FAILURE if row["judged"] else FAULT) if has_room else None
        if row["success"] and row["severity"] > self.bar(agent):
            return NARROWEST
        return SAMPLE if is_sampled(row["id"], self._keep.sample) else None

    def _enter(self, kept: Kept) -> None:
        """Count a folder; one that is not among the narrowest any more is removed."""
        if kept.reason in {FAILURE, FAULT}:
            self._failures.setdefault(kept.agent, set()).add(kept.id)
        elif kept.reason == NARROWEST:
            narrowest = self._narrowest.setdefault(kept.agent, [])
            if any(each.id == kept.id for each in narrowest):
                return
            heapq.heappush(narrowest, kept)
            if len(narrowest) > self._keep.narrowest:
                left = heapq.heappop(narrowest)
                if is_sampled(left.id, self._keep.sample):
                    return
                shutil.rmtree(self._folder / left.agent / left.id, ignore_errors=True)

    def _unpack(self, kept: Kept, row: dict[str, Any], packed: bytes) -> None:
        """Write the files into a draft, and give it its name."""
        folder = self._folder / kept.agent / kept.id
        draft = folder.with_name(f".{folder.name}.part")
        shutil.rmtree(draft, ignore_errors=True)
        try:
            draft.mkdir(parents=True)
            with tarfile.open(fileobj=io.BytesIO(packed)) as tar:
                tar.extractall(draft, filter="data")
            write_json(draft / DRIVE_FILE, {**kept._asdict(), "row": row})
            shutil.rmtree(folder, ignore_errors=True)
            draft.rename(folder)
        except OSError as error:
            shutil.rmtree(draft, ignore_errors=True)
            raise UserError(
                f"{folder} could not be written: {error.strerror}; make room and go on with --resume"
            ) from error


def kept_in(folder: Path) -> list[Kept]:
    """The drives of a campaign with a folder, in the order of their numbers.

    Raises:
        UserError: a folder's document cannot be read.
    """
    found = []
    for path in (folder / RECORDS).glob(f"[!.]*/[!.]*/{DRIVE_FILE}"):
        document = read_json(path, "the drive's document")
        found.append(Kept(**{name: document[name] for name in Kept._fields}))
    return sorted(found, key=lambda kept: kept.number)


def folder_of(folder: Path, kept: Kept) -> Path:
    """The folder of a drive."""
    return folder / RECORDS / kept.agent / kept.id
