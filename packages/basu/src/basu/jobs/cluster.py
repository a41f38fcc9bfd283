"""Workers that are actors of a running Ray cluster. The extra ``cluster`` installs Ray.

Ray places the actors on nodes with a free processor, and starts the process of each. The pool replaces an actor that
has ended, by itself or with its node, and tries its job again elsewhere. Ray itself retries nothing, so that an attempt
is counted once.
"""

from __future__ import annotations

import contextlib
import logging
import socket
from typing import TYPE_CHECKING, Any

from basu.errors import BasuError, UserError
from basu.jobs.job import Died, JobOutcome, PlayerSpec, Ready, refusal, versions

try:
    import ray
    from ray.exceptions import RayActorError, RayError
    from ray.util.scheduling_strategies import NodeAffinitySchedulingStrategy
except ImportError as error:
    raise UserError("--ray needs Ray; install it with `pip install basu[cluster]`") from error

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.jobs.job import PlayerAnswer

AUTO = "auto"
CONNECT_S = 5.0  # of wall time for the address to answer
VERSIONS_S = 60.0  # of wall time for every node to say its versions


class _Remote:
    """The actor: a player, and the jobs that it plays."""

    def open(self, spec: PlayerSpec) -> PlayerAnswer:
        """Open the player, which stays open until the actor ends."""
        self._stack = contextlib.ExitStack()
        try:
            self._play = self._stack.enter_context(spec.open())
        except BasuError as error:
            return refusal(error)
        return Ready(versions())

    def play(self, data: Any) -> JobOutcome:  # noqa: ANN401 - plain data of a job
        """Play a job."""
        return self._play(data)

    def close(self) -> None:
        """Close the player in good order."""
        self._stack.close()


class ActorWorker:
    """An actor with the answer that it owes."""

    def __init__(self, spec: PlayerSpec) -> None:
        self._actor = ray.remote(num_cpus=1, max_restarts=0, max_task_retries=0)(_Remote).remote()
        self.owed: Any = self._actor.open.remote(spec)

    def give(self, data: Any) -> None:  # noqa: ANN401 - plain data of a job
        """Send a job's data."""
        self.owed = self._actor.play.remote(data)

    def answer(self) -> PlayerAnswer:
        """The answer, which has come."""
        owed, self.owed = self.owed, None
        try:
            answer: PlayerAnswer = ray.get(owed)
        except RayActorError as error:
            return Died(f"its actor or its node ended ({_first_line(error)})")
        except RayError as error:  # what the player raised is a bug of ours; Ray's text has its traceback
            return Died(f"it raised {_first_line(error)}")
        return answer

    def end(self, *, at_once: bool) -> None:
        """Close the player where there is time, and end the actor."""
        with contextlib.suppress(RayError):
            if not at_once:
                ray.wait([self._actor.close.remote()], timeout=CONNECT_S)
            ray.kill(self._actor, no_restart=True)


class RayBackend:
    """The backend of a `basu.jobs.pool.Pool`."""

    def __init__(self, spec: PlayerSpec, address: str) -> None:
        """Connect to the cluster at ``address``: ``auto``, or HOST:PORT.

        Raises:
            UserError: no cluster is there, or a node has other versions than this process.
        """
        self._spec = spec
        self._is_ours = not ray.is_initialized()
        if self._is_ours:
            _connect(address)
        _check_nodes()

    @staticmethod
    def processors() -> int:
        """The processors of the cluster."""
        return max(1, int(ray.cluster_resources().get("CPU", 1)))

    def start(self) -> ActorWorker:
        """Start an actor; Ray makes it when a node has a processor left."""
        return ActorWorker(self._spec)

    def answers(self, workers: Sequence[ActorWorker], timeout_s: float) -> list[tuple[ActorWorker, PlayerAnswer]]:
        """Wait until some have answered."""
        by_reference = {worker.owed: worker for worker in workers if worker.owed is not None}
        if not by_reference:
            return []
        ready, _ = ray.wait(list(by_reference), num_returns=1, timeout=timeout_s)
        return [(by_reference[reference], by_reference[reference].answer()) for reference in ready]

    def close(self) -> None:
        """Leave the cluster."""
        if self._is_ours:
            ray.shutdown()


def _connect(address: str) -> None:
    """Connect to a cluster.

    Raises:
        UserError: no cluster answers.
    """
    advice = "start one with `ray start --head`, or leave out --ray to drive on this machine"
    if address != AUTO:
        host, _, port = address.partition(":")
        try:
            socket.create_connection((host, int(port)), CONNECT_S).close()
        except (OSError, ValueError) as error:
            raise UserError(f"no Ray cluster answers at {address} ({error}); {advice}") from error
    try:
        ray.init(address=address, log_to_driver=True, logging_level=logging.ERROR)
    except (ConnectionError, RuntimeError, ValueError, RayError) as error:
        raise UserError(f"no Ray cluster answers at {address} ({_first_line(error)}); {advice}") from error


def _check_nodes() -> None:
    """Compare the versions of every node with ours, before anything is driven.

    Raises:
        UserError: a node does not answer, or has others.
    """
    ask = ray.remote(num_cpus=0, max_retries=0)(versions)
    for node in ray.nodes():
        if not node["Alive"]:
            continue
        where = NodeAffinitySchedulingStrategy(node_id=node["NodeID"], soft=False)
        name = node["NodeManagerHostname"]
        try:
            theirs = ray.get(ask.options(scheduling_strategy=where).remote(), timeout=VERSIONS_S)
        except RayError as error:
            raise UserError(f"the node {name} cannot load basu ({_first_line(error)}); install it there") from error
        for program, ours in versions().items():
            if theirs[program] != ours:
                raise UserError(
                    f"the node {name} has {program} {theirs[program]}, and this command {ours}; install the same "
                    "versions on every node"
                )


def _first_line(error: BaseException) -> str:
    lines = str(error).strip().splitlines() or [type(error).__name__]
    return lines[0] if not isinstance(error, RayError) or len(lines) == 1 else lines[-1].strip() or lines[0]
