"""`Outcome` of a run, `Status` for ``result.json``, and `Fault`: the party at fault and exit code of ``basu run``."""

from __future__ import annotations

import enum
from typing import NamedTuple

EXIT_CODES = (
    "exit status: 0 completed, 1 the agent failed, 2 something given was wrong, 3 the simulator failed, 130 interrupted"
)


class Fault(enum.Enum):
    """The party at fault for the end of a run; the value is the exit code."""

    NONE = 0
    AGENT = 1
    SETUP = 2
    SIMULATOR = 3
    BENCHMARK = 70  # a bug of ours: EX_SOFTWARE of sysexits.h
    USER = 130  # Ctrl-C: 128 + SIGINT, as shells have it


class Status(enum.Enum):
    """The ``status`` of a result."""

    COMPLETED = "Completed"
    AGENT_CRASHED = "AgentCrashed"  # it raised
    AGENT_TIMED_OUT = "AgentTimedOut"  # one of its calls took longer than the limit
    AGENT_INVALID_CONTROL = "AgentInvalidControl"  # run_step returned no usable control
    ROUTE_TIMEOUT = "RouteTimeout"  # the simulated time for the route was used up
    ROUTE_BLOCKED = "RouteBlocked"  # the vehicle stood still for too long
    ROUTE_DEVIATION = "RouteDeviation"  # the vehicle went too far from the route
    SCENARIO_ENDED = "ScenarioEnded"  # a scenario's own run came to the scenario's end, or ended soon after a collision
    SCENARIO_TIMEOUT = "ScenarioTimeout"  # the simulated time for the scenario was used up
    STOPPED = "Stopped"  # --stop-after ended the drive before the end of its route
    SETUP_FAILED = "SetupFailed"
    ENDED_FROM_OUTSIDE = "EndedFromOutside"  # the machine ran out of memory that others than the agent used
    SIMULATOR_FAILED = "SimulatorFailed"
    BENCHMARK_FAILED = "BenchmarkFailed"
    INTERRUPTED = "Interrupted"

    @property
    def fault(self) -> Fault:
        """The party at fault."""
        return FAULT_OF[self]


FAULT_OF = {
    Status.COMPLETED: Fault.NONE,
    Status.AGENT_CRASHED: Fault.AGENT,
    Status.AGENT_TIMED_OUT: Fault.AGENT,
    Status.AGENT_INVALID_CONTROL: Fault.AGENT,
    Status.ROUTE_TIMEOUT: Fault.AGENT,
    Status.ROUTE_BLOCKED: Fault.AGENT,
    Status.ROUTE_DEVIATION: Fault.AGENT,
    Status.SCENARIO_ENDED: Fault.NONE,
    Status.SCENARIO_TIMEOUT: Fault.AGENT,
    Status.STOPPED: Fault.NONE,
    Status.SETUP_FAILED: Fault.SETUP,
    Status.ENDED_FROM_OUTSIDE: Fault.SETUP,
    Status.SIMULATOR_FAILED: Fault.SIMULATOR,
    Status.BENCHMARK_FAILED: Fault.BENCHMARK,
    Status.INTERRUPTED: Fault.USER,
}


class Outcome(NamedTuple):
    """The end of a run with a sentence about it."""

    status: Status
    message: str
