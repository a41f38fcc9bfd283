"""A PettingZoo environment with several vehicles under test in one world, on the benchmark's own episode.

``ShuttlesEnv(shuttles=2)`` is a ``pettingzoo.ParallelEnv``. Its agents have the roles of the vehicles as names. The
first is ``hero``; the others have their number behind that. Each stands ``headway_m`` ahead of the one before on the
same route. Actions, observations and rewards are those of `basu.gym`. An agent leaves ``agents`` in the step in which
its drive is over. Its vehicle leaves the world soon after, and the others drive on.
"""

from __future__ import annotations

import contextlib
import weakref
from typing import TYPE_CHECKING, Any

from basu.conditions import ROLE, SimulatorSpec
from basu.episode import DriverResponse, DriverSetup, Episode, Towns
from basu.errors import UserError
from basu.gym import route_spec
from basu.gym_spaces import Reward, action_space, control_from, observation_space
from basu.gym_steps import JudgedSteps
from basu.simulator import simulator_for

try:
    import pettingzoo
except ImportError as error:
    raise UserError("basu.gym_parallel needs pettingzoo; install it with `pip install basu[multi]`") from error

if TYPE_CHECKING:
    from collections.abc import Mapping

    import gymnasium
    import numpy as np
    from numpy.typing import NDArray

    Observations = dict[str, NDArray[np.float32]]

SEEDS = 2**31


class ShuttlesEnv(pettingzoo.ParallelEnv):  # type: ignore[misc]  # the package has no annotations
    """Several vehicles on a route of Linden. The docstring of `basu.gym` has shapes and units."""

    metadata: dict[str, Any] = {"render_modes": [], "name": "basu_shuttles_v0"}  # noqa: RUF012 - as the base has it

    def __init__(
        self,
        *,
        shuttles: int = 2,
        headway_m: float = 100.0,
        reward: Reward | None = None,
        host: str | None = None,
        port: int = 2000,
        timeout_s: float = 20.0,
        **route: Any,  # noqa: ANN401 - the keywords of `basu.gym.route_spec`
    ) -> None:
        """Start a simulator, or connect to the one at ``host``; ``route`` has keywords of `basu.gym.route_spec`.

        Raises:
            UserError: there is no such route, vehicle or weather, or a number cannot be used.
            SimulatorError: there is no simulator.
        """
        if shuttles < 1 or headway_m <= 0.0:
            raise UserError(f"shuttles is {shuttles} and headway_m {headway_m:g}; both must be above 0")
        self.render_mode = None
        self._reward = Reward() if reward is None else reward
        spec = route_spec(**route, timeout_s=timeout_s)
        self.possible_agents = [ROLE, *(f"{ROLE}_{number}" for number in range(2, shuttles + 1))]
        self.agents: list[str] = []
        self._action_spaces = {name: action_space() for name in self.possible_agents}
        self._observation_spaces: dict[str, gymnasium.spaces.Space[Any]] = {
            name: observation_space() for name in self.possible_agents
        }
        drivers = [DriverSetup(role=name, start_m=headway_m * place) for place, name in enumerate(self.possible_agents)]
        self._resources = contextlib.ExitStack()
        simulator = self._resources.enter_context(
            simulator_for(SimulatorSpec(host=host, port=port, timeout_s=timeout_s))
        )
        self.episode = Episode(simulator, spec, towns=Towns(simulator), drivers=drivers)
        self._resources.callback(self.episode.close)
        weakref.finalize(self, self._resources.close)  # also where close() is forgotten
        self._steps: dict[str, JudgedSteps] = {}
        self._next_seed = 0

    def observation_space(self, agent: str) -> gymnasium.spaces.Space[Any]:
        """Return the space of an agent's observations."""
        return self._observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.spaces.Space[Any]:
        """Return the space of an agent's actions."""
        return self._action_spaces[agent]

    def reset(
        self,
        seed: int | None = None,
        options: dict[str, Any] | None = None,  # noqa: ARG002 - PettingZoo's signature
    ) -> tuple[dict[str, Observations], dict[str, dict[str, Any]]]:
        """Begin an episode; all that is random in it comes from ``seed``. Without one it is the last seed plus 1.

        Raises:
            SimulatorError: the simulator failed.
        """
        drawn = self._next_seed if seed is None else seed
        self._next_seed = (drawn + 1) % SEEDS
        self.episode.reset(drawn)
        self.agents = list(self.possible_agents)
        self._steps = {
            name: JudgedSteps(self.episode, vehicle, self._reward)
            for name, vehicle in zip(self.agents, self.episode.vehicles, strict=True)
        }
        first = {name: steps.first() for name, steps in self._steps.items()}
        return {name: seen for name, (seen, _) in first.items()}, {name: info for name, (_, info) in first.items()}

    def step(
        self, actions: Mapping[str, NDArray[np.float32]]
    ) -> tuple[
        dict[str, Observations],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """Drive for 0.05 s; ``actions`` has one for each name in ``agents``.

        Raises:
            UserError: an action is missing, has a wrong shape, or a value that is no number in -1..1.
            SimulatorError: the simulator failed.
        """
        missing = [name for name in self.agents if name not in actions]
        if missing:
            raise UserError(f"there is no action for {', '.join(missing)}; give one for each name in env.agents")
        if not self.agents:
            return {}, {}, {}, {}, {}
        self.episode.step(
            [
                DriverResponse(control_from(actions[name])) if name in self.agents else None
                for name in self.possible_agents
            ]
        )
        found = {name: self._steps[name].next() for name in self.agents}
        self.agents = [name for name in self.agents if not (found[name][2] or found[name][3])]
        return (
            {name: each[0] for name, each in found.items()},
            {name: each[1] for name, each in found.items()},
            {name: each[2] for name, each in found.items()},
            {name: each[3] for name, each in found.items()},
            {name: each[4] for name, each in found.items()},
        )

    def render(self) -> None:
        """Nothing is drawn: read the record, or watch with a CARLA client."""

    def close(self) -> None:
        """End the episode, and the simulator where it is ours."""
        self._resources.close()
