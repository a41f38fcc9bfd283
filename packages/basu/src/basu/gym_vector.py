"""Many gymnasium environments at once: each in a worker process, with a simulator of its own.

After ``import basu.gym``, ``gymnasium.make_vec("basu/Linden-v0", num_envs=4)`` makes one. It keeps the contract of
``gymnasium.vector.AsyncVectorEnv``, and its workers are those of campaigns (`basu.jobs`). A worker that dies or hangs
is replaced. Then its episode is truncated with ``info["restarted"]``, and all others go on.
"""

from __future__ import annotations

import contextlib
import time
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space, concatenate, create_empty_array, iterate

from basu.errors import SimulatorError, UserError
from basu.gym import ShuttleEnv
from basu.gym_spaces import action_space, observation_space
from basu.jobs.job import Died, JobOutcome, PlayerSpec, Ready, Refused, raised
from basu.jobs.processes import Processes

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from basu.jobs.job import Play, PlayerAnswer
    from basu.jobs.processes import ProcessWorker

Observations = dict[str, "NDArray[np.float32]"]
ANSWER_LIMIT_S = 120.0  # of wall time for a worker's start, reset or step; then it counts as hung
RESTARTS = 3  # of one worker in a row without a step


class ShuttleVectorEnv(VectorEnv[Observations, "NDArray[np.float32]", Any]):
    """``num_envs`` environments of one kind. Seeds count up from the first: environment i has ``seed + i``."""

    def __init__(
        self,
        num_envs: int,
        *,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        answer_limit_s: float = ANSWER_LIMIT_S,
        **settings: Any,  # noqa: ANN401 - those of ShuttleEnv
    ) -> None:
        """Start the workers; ``settings`` are those of `basu.gym.ShuttleEnv`, but for ``host``.

        Raises:
            UserError: the settings cannot be used.
            SimulatorError: there is no simulator.
        """
        self._workers: list[ProcessWorker] = []  # gymnasium closes an environment that is refused, too
        if num_envs < 1:
            raise UserError(f"num_envs is {num_envs}; it must be at least 1")
        if settings.get("host") is not None:
            raise UserError("every environment starts a simulator of its own; leave out host and port")
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        if self.autoreset_mode is AutoresetMode.DISABLED:
            raise UserError("autoreset_mode is Disabled; choose NextStep or SameStep")
        self.num_envs, self.render_mode, self.spec = num_envs, None, None
        self.metadata = {**ShuttleEnv.metadata, "autoreset_mode": self.autoreset_mode}
        self.single_observation_space, self.single_action_space = observation_space(), action_space()
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._limit_s = answer_limit_s
        self._backend = Processes(PlayerSpec(f"{__name__}:open_environment", (settings,)))
        self._seen: list[Any] = [self.single_observation_space.sample()] * num_envs
        self._resets = np.ones(num_envs, dtype=np.bool_)  # environments that begin an episode at the next step
        self._restarts = np.zeros(num_envs, dtype=np.int64)
        self._workers = [self._backend.start() for _ in range(num_envs)]
        try:
            self._wait_until_ready(range(num_envs))
        except BaseException:
            self.close()
            raise

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Observations, dict[str, Any]]:
        """Begin an episode in every environment.

        Raises:
            SimulatorError: a worker ends again and again.
        """
        seeds = [None] * self.num_envs if seed is None else seed
        if isinstance(seeds, int):
            self._np_random = np.random.default_rng(seeds)
            seeds = [seeds + index for index in range(self.num_envs)]
        if len(seeds) != self.num_envs:
            raise UserError(f"{len(seeds)} seeds for {self.num_envs} environments; give one to each, or a number")
        infos: dict[str, Any] = {}
        given = {index: ("reset", each, options) for index, each in enumerate(seeds)}
        for index, (seen, info) in self._begun(given).items():
            self._seen[index] = seen
            infos = self._add_info(infos, info, index)
        self._resets[:] = False
        return self._observations(), infos

    def step(
        self, actions: NDArray[np.float32]
    ) -> tuple[Observations, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Drive for 0.05 s in every environment at the same time.

        Raises:
            SimulatorError: a worker ends again and again.
        """
        rewards = np.zeros(self.num_envs, dtype=np.float64)
        terminated, truncated = (np.zeros(self.num_envs, dtype=np.bool_) for _ in range(2))
        infos: dict[str, Any] = {}
        each_action = list(iterate(self.action_space, actions))
        given: dict[int, tuple[Any, ...]] = {
            index: ("reset", None, None) if self._resets[index] else ("step", each_action[index])
            for index in range(self.num_envs)
        }
        self._resets[:] = False
        for index, answer in self._played(given).items():
            if answer is None:
                truncated[index] = True
                infos = self._add_info(infos, {"restarted": True}, index)
            elif given[index][0] == "reset":
                self._seen[index], info = answer
                infos = self._add_info(infos, info, index)
            else:
                self._seen[index], rewards[index], terminated[index], truncated[index], info = answer
                infos = self._add_info(infos, info, index)
        ended = np.flatnonzero(terminated | truncated).tolist()
        if self.autoreset_mode is AutoresetMode.NEXT_STEP:
            self._resets[ended] = True
        else:
            infos = self._begin_again(ended, infos)
        return self._observations(), rewards, terminated, truncated, infos

    def close_extras(self, **_kwargs: Any) -> None:  # noqa: ANN401 - gymnasium's signature
        """End all workers."""
        for worker in self._workers:
            worker.end(at_once=False)
        self._workers = []

    def _begin_again(self, ended: Sequence[int], infos: dict[str, Any]) -> dict[str, Any]:
        """Begin the next episode in environments that have ended, in the step that ended them."""
        for index in ended:
            infos = self._add_info(infos, {"final_obs": self._seen[index]}, index)
        for index, (seen, _info) in self._begun(dict.fromkeys(ended, ("reset", None, None))).items():
            self._seen[index] = seen
        return infos

    def _observations(self) -> Observations:
        """The observations of all environments, copied."""
        empty = create_empty_array(self.single_observation_space, n=self.num_envs)
        return concatenate(self.single_observation_space, self._seen, empty)  # type: ignore[arg-type, return-value]

    def _begun(self, given: dict[int, tuple[Any, ...]]) -> dict[int, Any]:
        """Reset environments and return the answers; if a worker ends in a reset, a new worker repeats that reset.

        Raises:
            SimulatorError: a worker ends again and again.
        """
        found: dict[int, Any] = {}
        while given:
            answers = self._played(given)
            found |= {index: answer for index, answer in answers.items() if answer is not None}
            given = {index: given[index] for index, answer in answers.items() if answer is None}
        return dict(sorted(found.items()))

    def _played(self, given: dict[int, tuple[Any, ...]]) -> dict[int, Any]:
        """What came of jobs for workers, in their order; None where a worker ended and is replaced.

        Raises:
            SimulatorError: a worker ends again and again.
        """
        for index, job in given.items():
            message = job
            if job[0] == "reset" and job[1] is None and self._restarts[index]:  # its random numbers are lost
                message = ("reset", int(self.np_random.integers(2**31)), job[2])
            self._workers[index].give(message)
        found, ended = dict[int, Any](), list[int]()
        for index, answer in self._answers(list(given)).items():
            if isinstance(answer, JobOutcome):
                found[index] = answer.value
                self._restarts[index] = 0
            else:
                found[index] = None
                ended.append(index)
        self._replace(ended)
        return found

    def _answers(self, indices: Sequence[int]) -> dict[int, PlayerAnswer]:
        """An answer of each of these workers, in their order; one that takes too long is ended.

        Raises:
            UserError, SimulatorError: an environment cannot be made.
        """
        deadline_s = time.monotonic() + self._limit_s
        waiting = {self._workers[index]: index for index in indices}
        found: dict[int, PlayerAnswer] = {}
        while waiting:
            rest_s = deadline_s - time.monotonic()
            answers = self._backend.answers(list(waiting), rest_s) if rest_s > 0.0 else []
            if not answers:
                found |= {index: Died(f"it gave no answer for {self._limit_s:g} s") for index in waiting.values()}
                break
            found |= {waiting.pop(worker): answer for worker, answer in answers}
        return dict(sorted(found.items()))

    def _replace(self, ended: Sequence[int]) -> None:
        """Start fresh workers in place of ended ones.

        Raises:
            SimulatorError: one ends again and again.
        """
        for index in ended:
            self._workers[index].end(at_once=True)
            self._restarts[index] += 1
            if self._restarts[index] > RESTARTS:
                raise SimulatorError(f"the worker of environment {index} ended {RESTARTS} times without a step")
            self._workers[index] = self._backend.start()
        self._wait_until_ready(ended)

    def _wait_until_ready(self, indices: Sequence[int]) -> None:
        """Wait for the first answers of workers.

        Raises:
            UserError, SimulatorError: an environment cannot be made.
        """
        for index, answer in self._answers(indices).items():
            if isinstance(answer, Refused):
                raise raised(answer)
            if not isinstance(answer, Ready):
                raise SimulatorError(f"the worker of environment {index} could not be started; its error stands above")


@contextlib.contextmanager
def open_environment(settings: dict[str, Any]) -> Iterator[Play]:
    """The player of a worker: one environment.

    Raises:
        UserError, SimulatorError: it cannot be made.
    """
    environment = ShuttleEnv(**settings)

    def play(job: tuple[Any, ...]) -> JobOutcome:
        word, *arguments = job
        if word == "reset":
            seed, options = arguments
            return JobOutcome(environment.reset(seed=seed, options=options))
        return JobOutcome(environment.step(*arguments))

    try:
        yield play
    finally:
        environment.close()
