"""`CampaignRun`: the batch of a campaign, which keeps rows and the telling folders, and stops by a rule."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from basu.campaigns.campaign_folder import PROGRESS_FILE, STOP_FILE
from basu.campaigns.columns import columns_of
from basu.campaigns.drive_table import DriveTable, journal_rows, open_drives
from basu.campaigns.looks import Looks
from basu.campaigns.records import Records
from basu.campaigns.search_part import search_plugin
from basu.jobs.job import Job
from basu.metrics.registry import user_metrics
from basu.outcome import Fault
from basu.output.progress import drives_bar
from basu.output.report.documents import write_json
from basu.running.batch import Batch

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from basu.campaigns.plan import CampaignPlan
    from basu.campaigns.search_part import SearchStates
    from basu.campaigns.storage import Mirror
    from basu.jobs.pool import Pool
    from basu.running.drive import DriveDone

PROGRESS_S = 2.0  # of wall time from one writing of the progress to the next


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSettings:
    """How a campaign is worked off; nothing of it changes a result."""

    file: Path
    output: Path  # the parent of the campaign's folder on this machine
    store: str | None = None  # the address of the parent on a store, to which results are copied
    resume: bool = False
    workers: int | None = None  # None: one for each processor
    drives: int | None = None  # only the first so many
    ray: str | None = None  # the address of a Ray cluster; None: processes of this machine


class CampaignRun(Batch):
    """One command at work on a campaign."""

    def __init__(
        self, plan: CampaignPlan, folder: Path, table: DriveTable, settings: RunSettings, mirror: Mirror | None
    ) -> None:
        super().__init__(folder, {})  # its folders have other names, see `Records`
        self._mirror = mirror
        self.plan, self.table, self._settings = plan, table, settings
        self._own = user_metrics(plan.metric_files)
        self.limit = plan.size if settings.drives is None else min(plan.size, settings.drives)
        names = [agent.name for agent in plan.agents]
        self._records = Records(folder, plan.campaign.keep)
        self._search_states = _search_states(plan, folder)
        self._looks = Looks(plan.campaign.until, names, plan.campaign.confidence, table.rows)
        self._failures = dict.fromkeys(names, 0)
        self._began_s, self._written_s = time.monotonic(), 0.0
        self._driven = 0  # by this command
        self._given: dict[int, dict[str, Any]] = {}  # jobs in work

    def drive_all(self, pool: Pool[Any]) -> int:
        """Drive what is left; the exit code.

        Raises:
            UserError, SimulatorError: see ``run_campaign``; what was driven is kept.
        """
        interrupted = False
        self._take_up()
        bar = drives_bar(self.limit, " drives", initial=self.table.number)
        try:
            with bar:
                if not self._looks.is_answered():
                    for _ in self.play(pool.play(self._jobs()), bar):
                        failed = ", ".join(f"{name} {n} failed" for name, n in self._failures.items())
                        bar.set_postfix_str(failed, refresh=False)
                        if self._looks.is_answered():
                            break
        except KeyboardInterrupt:
            interrupted = True
        finally:
            pool.close()
            if self._looks.stopped_after is not None:
                self._stop(self._looks.stopped_after)
            self.table.close()
            self._progress(at_once=True)
            if self._mirror is not None:
                self._mirror.copy(with_journals=True)
        print(self._words(interrupted=interrupted))
        return Fault.USER.value if interrupted else 0

    def _take_up(self) -> None:
        """Count what earlier commands have left."""
        open_rows = {row["number"]: row for row in journal_rows(self.folder)}
        if any((self.folder / "drives").glob("*/block-*.parquet")):
            columns = ["number", "agent", "judged", "success", "fault", "severity"]
            for batch in open_drives(self.folder).to_batches(columns=columns):
                for row in batch.to_pylist():
                    if row["number"] not in open_rows:
                        self._count(row)
        for row in open_rows.values():
            self._count(row)
        for block in range(-(-self.plan.size // self.table.block)):
            if not self.table.is_complete(block):
                break
            self._looks.complete(block)

    def _count(self, row: dict[str, Any]) -> None:
        if self._search_states is not None:
            self._search_states.count(row)
        if row["success"] is False:
            self._failures[row["agent"]] += 1

    def _jobs(self) -> Iterator[Job | None]:
        """The jobs that are left, made one by one; None while a search waits for what came of others."""
        for number in self.table.pending(self.limit):
            while (values := self._values(number)) is None:
                yield None
            job = self.plan.job(number, values)
            self._given[number] = job
            yield Job(number, {**job, "bar": self._records.bar(job["agent_name"])})

    def _values(self, number: int) -> dict[str, float] | None:
        """What a job's search has chosen; None while it has not."""
        return {} if self._search_states is None else self._search_states.values(number)

    def publish(self, done: DriveDone) -> DriveDone:
        """Write the row of a drive, and its folder before that; return it.

        Raises:
            UserError: the disk is full, or the store refuses it.
        """
        job = self._given.pop(done.number)
        row = {
            "number": done.number,
            **{name: job[name] for name in ("id", "kind", "subject", "identity", "town", "weather", "seed")},
            "agent": job["agent_name"],
            "track": job["track"],
            **{name: job[name] for name in ("vehicles", "walkers", "density_per_km")},
            **{f"parameter_{name}": value for name, value in job["parameters"].items()},
            "attempts": done.attempts,
            **columns_of(done.result, self._own),
            **done.cost,
        }
        self._records.offer(row, done.packed)
        block = self.table.add(row)
        self._count(row)
        if block is not None:
            self._looks.complete(block)
            if self._mirror is not None:
                self._mirror.copy()
        self._driven += 1
        self._progress()
        return done

    def _stop(self, blocks: int) -> None:
        """Keep the rows of the blocks that answered the question, and no others: they are the same in every run."""
        self.table.cut(blocks)
        write_json(self.folder / STOP_FILE, {"drives": self.table.number, "blocks": blocks})

    def _progress(self, *, at_once: bool = False) -> None:
        """Write how far it has come, every few seconds."""
        now_s = time.monotonic()
        if not at_once and now_s - self._written_s < PROGRESS_S:
            return
        self._written_s = now_s
        document = {
            "done": self.table.number,
            "planned": self.limit,
            "failures": self._failures,
            "driven_by_this_command": self._driven,
            "wall_s": round(now_s - self._began_s, 1),
        }
        write_json(self.folder / PROGRESS_FILE, document)

    def _words(self, *, interrupted: bool) -> str:
        """Return how the campaign ended, in words."""
        done, left = self.table.number, self.limit - self.table.number
        where = self.folder if self._mirror is None else self._mirror.store.address
        folder = f"campaign folder   {where}"
        if interrupted:
            output = self._settings.store or self._settings.output
            work = f" --work {self._settings.output}" if self._settings.store else ""
            again = f"basu campaign run {self._settings.file} --output {output}{work} --resume"
            return f"interrupted after {done} of {self.limit} drives; go on with `{again}`\n{folder}"
        if self._looks.stopped_after is not None:
            until = self.plan.campaign.until
            assert until is not None, "only a rule stops a campaign"
            said = f"every agent's success rate is known within {until.width:g}; {left} drives were not needed"
            return f"{done} drives: {said}\n{folder}"
        return f"{done} drives\n{folder}\nreport            basu campaign report {where}"


def _search_states(plan: CampaignPlan, folder: Path) -> SearchStates | None:
    """The searches of a campaign; None where it has none, so that it needs no plugin."""
    if all(part.search is None for part in plan.parts):
        return None
    return search_plugin().states(plan, folder)
