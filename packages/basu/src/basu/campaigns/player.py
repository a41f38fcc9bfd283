"""The player of a campaign's drives: a simulator, its map and the agents' processes, kept between drives."""

from __future__ import annotations

import contextlib
import io
import os
import platform
import shutil
import tarfile
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from basu.agents.process.gate import closed_ports
from basu.agents.process.remote_agent import find_agent
from basu.campaigns.cost import cost_of
from basu.campaigns.plan import ROUTE
from basu.campaigns.settings import AS_GIVEN
from basu.conditions import SimulatorSpec
from basu.episode import Towns
from basu.episode.failures import outcome_of
from basu.errors import AgentError, SimulatorError, UserError
from basu.jobs.job import After, JobOutcome, PlayerSpec
from basu.metrics.registry import user_metrics
from basu.options.run import RunOptions
from basu.outcome import Status
from basu.output.report.drive_row import severity
from basu.running.drive import not_begun
from basu.running.one_run import Session, run_one
from basu.running.preparation import agents_fault, new_agents, prepare
from basu.running.scenario_runs.one_case import CaseSession, play_case
from basu.running.scenario_runs.options import ScenarioOptions
from basu.scenarios.cases import open_library
from basu.simulator import simulator_for

if TYPE_CHECKING:
    from collections.abc import Iterator

    from basu.agents.process.remote_agent import FoundAgent
    from basu.jobs.job import Play
    from basu.metrics.result import Result
    from basu.metrics.scoring import Scoring
    from basu.running.drive import DriveDone
    from basu.running.preparation import Plan
    from basu.scenarios.cases import Library
    from basu.simulator import Simulator

AGAIN = frozenset({Status.SIMULATOR_FAILED})  # tried again elsewhere, unless the record was unsafe before


@dataclass(frozen=True, slots=True, kw_only=True)
class PlayerSettings:
    """What all drives of a campaign share; plain values that any node understands."""

    agents: tuple[str, ...]  # as the plan has them
    scoring: Scoring
    vehicle: str | None
    open: bool  # without the gate
    step_limit_s: float
    agent_memory_gb: float | None
    agent_writes: tuple[str, ...]
    scenario_files: tuple[Path, ...]
    metric_files: tuple[Path, ...]
    sample: float  # share of drives that leave a record in any case
    scratch: Path | None  # for folders of drives in work; None: the system's
    record: bool = False  # CARLA's log in the folder of each drive


def drive_player(settings: PlayerSettings) -> PlayerSpec:
    """The player as a value that any process can open."""
    return PlayerSpec(f"{__name__}:open_player", (settings,))


@contextlib.contextmanager
def open_player(settings: PlayerSettings) -> Iterator[Play]:
    """Load the agents, start a simulator, and drive jobs in it.

    Raises:
        UserError: an agent, a scenario's or a metric's file cannot be used here.
        SimulatorError: there is no simulator.
    """
    library = open_library(settings.scenario_files)
    user_metrics(settings.metric_files)  # a file that cannot be used here is refused before the drives
    with tempfile.TemporaryDirectory(dir=settings.scratch, prefix="drives-", ignore_cleanup_errors=True) as scratch:
        agents = {
            typed: find_agent(
                typed,
                memory_gb=settings.agent_memory_gb,
                writes=settings.agent_writes,
                closed_ports=closed_ports(None, 0, is_open=settings.open),
                output=None if settings.open else Path(scratch),
            )
            for typed in settings.agents
        }
        recordings = Path(scratch) if settings.record else None
        with simulator_for(SimulatorSpec(is_open=settings.open, recordings=recordings)) as simulator:
            driver = _Player(settings, agents, library, simulator, Path(scratch))
            yield driver.play


class _Player:
    """Drives jobs in one simulator."""

    def __init__(
        self,
        settings: PlayerSettings,
        agents: dict[str, FoundAgent],
        library: Library,
        simulator: Simulator,
        scratch: Path,
    ) -> None:
        self._settings, self._agents, self._library = settings, agents, library
        self._simulator, self._towns, self._scratch = simulator, Towns(simulator), scratch
        self._plans: dict[tuple[str, str, str, bool], Plan] = {}

    def play(self, job: dict[str, Any]) -> JobOutcome:
        """Drive one job; whatever goes wrong becomes its result. The folder is packed where it is worth keeping."""
        began_s, before = time.perf_counter(), cost_of()
        try:
            done = self._route(job) if job["kind"] == ROUTE else self._case(job)
        except (UserError, AgentError, SimulatorError) as error:
            done = not_begun(outcome_of(error, self._simulator.why_gone))
        cost: dict[str, Any] = {}
        packed = None
        if done.folder is not None:
            files = [path.stat().st_size for path in done.folder.rglob("*") if path.is_file()]
            cost["records_bytes"] = sum(files)
            packed = _tar(done.folder) if self._is_kept(job, done.result) else None
            shutil.rmtree(done.folder)
        after = cost_of()
        cost |= {
            "wall_s": round(time.perf_counter() - began_s, 3),
            "cpu_s": round(max(0.0, after.cpu_s - before.cpu_s), 3),
            "memory_mb": round(after.memory_mb, 1),
            "host": platform.node(),
            "worker": os.getpid(),
        }
        sent = done.to_send()._replace(folder=None, packed=packed, cost=cost)
        return JobOutcome(sent, _after(done.result.outcome.status, done.result.success.passed))

    def _is_kept(self, job: dict[str, Any], result: Result) -> bool:
        """Return whether a folder is a failure's, one of the sample, or of a worse drive than the command has seen."""
        passed = result.success.passed
        return passed is not True or severity(result) > job["bar"] or is_sampled(job["id"], self._settings.sample)

    def _route(self, job: dict[str, Any]) -> DriveDone:
        """Drive a route.

        Raises:
            UserError, AgentError, SimulatorError: it cannot begin, which is an outcome as well.
        """
        settings, others = self._settings, job["density_per_km"]
        options = RunOptions(
            agent=job["agent"],
            track=job["track"],
            routes=job["file"],
            route_id=job["identity"],
            seed=job["seed"],
            weather=None if job["weather"] == AS_GIVEN else job["weather"],
            vehicles=job["vehicles"],
            walkers=job["walkers"],
            traffic_density=others,
            vehicle=settings.vehicle,
            open=settings.open,
            with_scenarios=job["scenarios"],
            scenario_files=settings.scenario_files,
            metric_files=settings.metric_files,
            record=settings.record,
            step_limit_s=settings.step_limit_s,
            agent_memory_gb=settings.agent_memory_gb,
            agent_writes=settings.agent_writes,
        )
        plan = self._plan(options, job)
        with agents_fault(plan.loaded):
            agents = new_agents(plan.loaded, options, job["seed"], options.routes, has_conditions=False)
        session = Session(options, settings.scoring, plan, self._simulator, self._towns, quiet=True, pictures=False)
        run = plan.jobs[0]._replace(seed=job["seed"])
        return run_one(session, [plan.shuttles[0]._replace(agents=agents)], run, output=self._scratch, name=job["id"])

    def _plan(self, options: RunOptions, job: dict[str, Any]) -> Plan:
        """The plan of an agent on a route; made once."""
        key = (job["agent"], job["file"], job["identity"], job["scenarios"])
        if key not in self._plans:
            self._plans[key] = prepare(options, self._agents[job["agent"]], has_conditions=False)
        return self._plans[key]

    def _case(self, job: dict[str, Any]) -> DriveDone:
        """Play a case."""
        settings = self._settings
        options = ScenarioOptions(
            what=(job["identity"],),
            agents=(job["agent"],),
            track=job["track"],
            files=settings.scenario_files,
            seed=job["seed"],
            weather=None if job["weather"] == AS_GIVEN else job["weather"],
            vehicle=settings.vehicle,
            open=settings.open,
            step_limit_s=settings.step_limit_s,
            agent_memory_gb=settings.agent_memory_gb,
            agent_writes=settings.agent_writes,
            metric_files=settings.metric_files,
            record=settings.record,
        )
        session = CaseSession(options, self._simulator, self._towns, settings.scoring, pictures=False)
        (playable,) = self._library.of_id(job["identity"])
        return play_case(session, self._agents[job["agent"]], playable, self._scratch, job["id"])


def _after(status: Status, success: bool | None) -> After:  # noqa: FBT001 - a value, not a switch
    """Return what follows a drive; an unsafe record is a failure, so no fault of the simulator gives it another try."""
    if status in AGAIN:
        return After.FRESH if success is False else After.AGAIN
    return After.FRESH if status is Status.BENCHMARK_FAILED else After.GO_ON


def is_sampled(identity: str, share: float) -> bool:
    """Whether a job with this id belongs to the sample that leaves its records."""
    return int(identity[:8], 16) < share * 16**8


def _tar(folder: Path) -> bytes:
    """A folder's files as a tar file."""
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w") as tar:
        for path in sorted(folder.iterdir()):
            tar.add(path, arcname=path.name)
    return buffer.getvalue()
