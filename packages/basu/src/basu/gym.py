"""A gymnasium environment on the benchmark's own episode.

After ``import basu.gym``, ``gymnasium.make("basu/Linden-v0")`` makes one, and ``gymnasium.make_vec`` several at once:
each in a process with a simulator of its own (`basu.gym_vector`).

Action, ``Box(2)`` in -1..1: ``[pedals, steer]``. Positive pedals are the throttle, negative ones the brake; positive
steer turns right. One step is 0.05 s of simulated time.

Observation, a ``Dict`` of float32 boxes in the vehicle's frame (x forward, y to the right; m, m/s, rad):

- ``ego`` (6,): speed; acceleration forward, m/s²; yaw rate, clockwise; offset from the route, positive to the right;
  heading less the route's; posted limit, 0 where there is none.
- ``route`` (10, 2): x, y of the route's points 5, 10, ..., 50 m ahead; the last point again behind its end.
- ``stop_sign`` (2,): 1, and the way from the front bumper to the line of the next stop sign, negative beyond the line.
  Zeros if none is within 60 m, or if the vehicle has stopped there by the rule of `basu.metrics.stop_signs`.
- ``others`` (8, 6): the nearest vehicles, walkers and things on the road within 60 m, nearest first: 1, x, y, heading
  less ours, velocity x, y. Rows of zeros where there are fewer.

The values are clipped to the boxes' bounds. Reward: see ``Reward``. ``terminated`` on arrival, on leaving the route, on
standing still for too long, and at a scenario's end. It is ``truncated`` when the simulated time is used up. The
``info`` has ``route_s_m`` and ``infractions``: new ones, reported and rewarded at every tenth and the last step. Its
``reward_parts`` are the reward of the step by the names of ``Reward``'s fields. At the end it has ``outcome``,
``message``, and ``passed`` with its ``reasons`` (`basu.metrics.success`).
"""

from __future__ import annotations

import contextlib
import weakref
from typing import TYPE_CHECKING, Any

from basu.agents.autonomous_agent import AgentConfig
from basu.conditions import STEP_S, SimulatorSpec, Traffic
from basu.episode import DriverResponse, Episode, EpisodeSpec, Towns, case_spec
from basu.episode.world import weather_called
from basu.errors import UserError
from basu.files import find
from basu.routing.route_file import read_routes
from basu.scenarios.cases import by_id
from basu.scenarios.route_scenarios import scenarios_on
from basu.simulator import simulator_for

try:
    import gymnasium

    from basu.gym_spaces import Reward, action_space, control_from, observation_space
    from basu.gym_steps import JudgedSteps
except ImportError as error:
    raise UserError("basu.gym needs gymnasium; install it with `pip install basu[gym]`") from error

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from basu.simulator import Simulator


class ShuttleEnv(gymnasium.Env[dict[str, "NDArray[np.float32]"], "NDArray[np.float32]"]):
    """One vehicle on a route of Linden, or in one case of a scenario. The module's docstring has shapes and units."""

    metadata: dict[str, Any] = {"render_modes": [], "render_fps": round(1.0 / STEP_S)}  # noqa: RUF012 - as the base has it

    def __init__(
        self,
        *,
        routes: str = "routes/linden_short.xml",
        route_id: str | None = None,
        case: str | None = None,
        vehicle: str | None = None,
        vehicles: int = 0,
        walkers: int = 0,
        weather: str = "ClearNoon",
        with_scenarios: bool = True,
        reward: Reward | None = None,
        host: str | None = None,
        port: int = 2000,
        timeout_s: float = 20.0,
        render_mode: str | None = None,
    ) -> None:
        """Start a simulator, or connect to the one at ``host``. ``case`` names a scenario's case in place of a route.

        Raises:
            UserError: there is no such route, case, vehicle or weather.
            SimulatorError: there is no simulator.
        """
        if render_mode is not None:
            raise UserError(f"there is no render mode '{render_mode}'; read the record, or watch with a CARLA client")
        self.render_mode = None
        self._reward = Reward() if reward is None else reward
        wanted = SimulatorSpec(host=host, port=port, timeout_s=timeout_s)
        if case is not None:
            self._spec = case_spec(by_id(case), vehicle=vehicle, timeout_s=timeout_s)
        else:
            self._spec = route_spec(
                routes=routes,
                route_id=route_id,
                vehicle=vehicle,
                vehicles=vehicles,
                walkers=walkers,
                weather=weather,
                with_scenarios=with_scenarios,
                timeout_s=timeout_s,
            )
        self.action_space = action_space()
        self.observation_space: gymnasium.spaces.Space[Any] = observation_space()
        self._resources = contextlib.ExitStack()
        simulator: Simulator = self._resources.enter_context(simulator_for(wanted))
        self.episode = Episode(simulator, self._spec, towns=Towns(simulator))
        self._resources.callback(self.episode.close)
        weakref.finalize(self, self._resources.close)  # also where close() is forgotten

    def reset(
        self,
        *,
        seed: int | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[dict[str, NDArray[np.float32]], dict[str, Any]]:
        """Begin an episode; all that is random in it comes from ``seed``, or from the last seed that was given.

        Raises:
            UserError: ``options`` names a place to begin at, which only `linden_gym` has.
            SimulatorError: the simulator failed.
        """
        if options and "start_m" in options:
            raise UserError("through the client a drive begins at the route's beginning; start_m is of `linden_gym`")
        super().reset(seed=seed)
        drawn = seed if seed is not None else int(self.np_random.integers(2**31))
        self.episode.reset(drawn)
        self._judged = JudgedSteps(self.episode, self.episode.vehicle, self._reward)
        return self._judged.first()

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[dict[str, NDArray[np.float32]], float, bool, bool, dict[str, Any]]:
        """Drive for 0.05 s.

        Raises:
            UserError: the action has a wrong shape, or a value that is no number in -1..1.
            SimulatorError: the simulator failed.
        """
        answer, vehicle = DriverResponse(control_from(action)), self.episode.vehicle
        self.episode.step([answer])
        if vehicle.outcome is None and vehicle.ending is not None:  # it has arrived: its last frame is recorded
            self.episode.step([answer])
        return self._judged.next()

    def close(self) -> None:
        """End the episode, and the simulator where it is ours."""
        self._resources.close()


def route_spec(
    *,
    routes: str = "routes/linden_short.xml",
    route_id: str | None = None,
    vehicle: str | None = None,
    vehicles: int = 0,
    walkers: int = 0,
    weather: str = "ClearNoon",
    with_scenarios: bool = True,
    timeout_s: float = 20.0,
) -> EpisodeSpec:
    """Return the episode of one route of a file, the first where none is named.

    Raises:
        UserError: there is no such route.
    """
    found = read_routes(find(routes, "route file"))
    chosen = [route for route in found if route_id in {None, route.id}]
    if not chosen:
        raise UserError(f"{routes} has no route '{route_id}'; it has {', '.join(route.id for route in found)}")
    usual = AgentConfig()
    return EpisodeSpec(
        town=chosen[0].town,
        route=chosen[0],
        config=AgentConfig(vehicle=vehicle or usual.vehicle),
        weather=weather_called(weather),
        weather_along=chosen[0].weather,
        traffic=Traffic(vehicles, walkers),
        scenarios=scenarios_on(chosen[0]) if with_scenarios else (),
        lane_invasions=False,  # no reward reads them
        timeout_s=timeout_s,
    )


VECTOR = "basu.gym_vector:ShuttleVectorEnv"
gymnasium.register(id="basu/Linden-v0", entry_point="basu.gym:ShuttleEnv", vector_entry_point=VECTOR)
gymnasium.register(
    id="basu/LindenTraffic-v0",
    entry_point="basu.gym:ShuttleEnv",
    vector_entry_point=VECTOR,
    kwargs={"vehicles": 20, "walkers": 10},
)
