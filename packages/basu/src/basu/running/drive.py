"""The loop of a drive, `drive`, and `DriveDone`: what came of a drive, from the worker to the end of the command."""

from __future__ import annotations

import time
import traceback
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.episode import DriverResponse
from basu.errors import AgentError
from basu.metrics.result import judge
from basu.metrics.success import Success
from basu.outcome import Outcome, Status

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from basu.episode import Episode, VehicleUnderTest
    from basu.managers.agents_manager import AgentsManager
    from basu.metrics.result import Result
    from basu.records.history import History


class Driven(NamedTuple):
    """How a run ended and what was measured until then."""

    outcome: Outcome
    history: History | None  # None where nothing was driven
    wall_s: float  # from the first step to the last
    first_frame: int | None  # the server's number of it
    bug: Exception | None  # an error of our own, to be raised again once all is written
    agent_error: AgentError | None  # what the agent failed with; its cause has the traceback


class DriveDone(NamedTuple):
    """A drive on a route or in a case that is over, or that could not begin."""

    folder: Path | None  # a draft until the command has given it its name; None where nothing is left
    result: Result  # of the first vehicle, mostly the only one
    bug: Exception | str | None = None  # an error of our own: itself, or its traceback from another process
    number: int = 0  # of the job
    attempts: int = 1  # at the job
    packed: bytes | None = None  # the folder as a tar file, from a worker that keeps no folder
    cost: Mapping[str, Any] = {}  # of the worker: processor time, memory, host
    beside: tuple[Result, ...] = ()  # of the other vehicles of a run with several

    def to_send(self) -> DriveDone:
        """Return what another process may have of it: no record, which lies in the folder, and no exception."""
        bug = "".join(traceback.format_exception(self.bug)) if isinstance(self.bug, Exception) else self.bug
        beside = tuple(replace(each, history=None) for each in self.beside)
        return self._replace(result=replace(self.result, history=None), beside=beside, bug=bug)

    @property
    def results(self) -> tuple[Result, ...]:
        """The result of each vehicle."""
        return (self.result, *self.beside)


def not_begun(outcome: Outcome) -> DriveDone:
    """Return a drive that could not begin; nothing is left of it."""
    result = judge(outcome, None)
    return DriveDone(None, replace(result, success=Success(result.success.passed)))


def lost(sentence: str) -> DriveDone:
    """Return a drive over which every worker died; nothing is known of the agent."""
    return not_begun(Outcome(Status.BENCHMARK_FAILED, sentence))


def drive(episode: Episode, agents: Sequence[AgentsManager]) -> list[Driven]:
    """Drive an episode to the end of each of its vehicles, whatever that is; ``agents`` has one manager for each."""
    began_s = time.perf_counter()
    ended_s: dict[VehicleUnderTest, float] = {}
    try:
        episode.reset()
        began_s = time.perf_counter()
        while episode.driving:
            answers = _answers(episode, agents)
            if episode.driving:
                episode.step(answers)
            now_s = time.perf_counter()
            ended_s |= {each: now_s for each in episode.vehicles if each.outcome is not None and each not in ended_s}
    except (Exception, KeyboardInterrupt) as error:  # noqa: BLE001 - the episode classifies it
        episode.fail(error)
    now_s = time.perf_counter()
    episode.end()
    return [_driven(vehicle, ended_s.get(vehicle, now_s) - began_s) for vehicle in episode.vehicles]


def _answers(episode: Episode, agents: Sequence[AgentsManager]) -> list[DriverResponse | None]:
    """Ask the agents of all vehicles that wait, then collect their answers; an agent that fails ends its own drive.

    Agents with processes of their own work at the same time: the slowest of them says how long this takes.
    """
    answers: list[DriverResponse | None] = [None] * len(agents)
    asked = []
    for number, (vehicle, manager) in enumerate(zip(episode.vehicles, agents, strict=True)):
        if vehicle.waits:
            seen = vehicle.observation
            manager.perceive(seen.sensor_data)
            try:
                manager.ask(seen.frame)
                asked.append((number, vehicle, manager))
            except AgentError as error:
                episode.fail(error, vehicle)
    for number, vehicle, manager in asked:
        try:
            manager.answer(vehicle.observation.frame)
            answers[number] = DriverResponse(manager.control, manager.requested, manager.manual)
        except AgentError as error:  # noqa: PERF203 - once a vehicle
            episode.fail(error, vehicle)
    return answers


def _driven(vehicle: VehicleUnderTest, wall_s: float) -> Driven:
    """Return what came of a vehicle's drive, which is over."""
    assert vehicle.outcome is not None, "a drive ends with an outcome"
    return Driven(vehicle.outcome, vehicle.history, wall_s, vehicle.first_frame, vehicle.bug, vehicle.agent_error)
