"""Keeps ``CarlaDataProvider`` and ``GameTime`` going: our own, and ScenarioRunner's where an agent loaded those."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

    import carla

from basu.agents.leaderboard.provided.carla_data_provider import CarlaDataProvider
from basu.agents.leaderboard.provided.game_time import GameTime


class Feeds:
    """One run's. An agent may import ScenarioRunner's modules in the middle of it: they are looked for each step."""

    def __init__(self, client: carla.Client, world: carla.World, vehicle: carla.Vehicle, ego_route: Any) -> None:  # noqa: ANN401 - a list of (transform, option)
        self._client, self._world, self._vehicle, self._ego_route = client, world, vehicle, ego_route
        self._providers: list[Any] = []
        self._clocks: list[Any] = []
        self._begin()

    def tick(self, timestamp: carla.Timestamp) -> float:
        """Go on to a step of the simulator; the time in s since the run began, one step at the first."""
        self._begin()
        for provider in self._providers:
            provider.on_carla_tick()
        for clock in self._clocks:
            clock.on_carla_tick(timestamp)
        time_s: float = GameTime.get_time()
        return time_s

    def close(self) -> None:
        """Take the run away; what an agent spawned through ScenarioRunner's provider goes too, the vehicle does not."""
        for provider in self._providers:
            _pool(provider).pop(self._vehicle.id, None)
            provider.cleanup()
        for clock in self._clocks:
            clock.restart()
        self._providers, self._clocks = [], []

    def _begin(self) -> None:
        """Hand the run to whoever has not got it yet."""
        for provider in _loaded(CarlaDataProvider, "srunner.scenariomanager.carla_data_provider"):
            if provider not in self._providers:
                self._providers.append(provider)
                provider.set_client(self._client)
                provider.set_world(self._world)
                provider.register_actor(self._vehicle)
                provider.set_ego_route(self._ego_route)
                _pool(provider)[self._vehicle.id] = self._vehicle
        for clock in _loaded(GameTime, "srunner.scenariomanager.timer"):
            if clock not in self._clocks:
                self._clocks.append(clock)
                clock.restart()


def _loaded(ours: type, module: str) -> Iterator[Any]:
    """Our class, and theirs of the same name where it is loaded and another one."""
    yield ours
    theirs = getattr(sys.modules.get(module), ours.__name__, ours)
    if theirs is not ours:
        yield theirs


def _pool(provider: Any) -> Any:  # noqa: ANN401 - theirs
    """Where ScenarioRunner's provider looks for the hero; the public way into it is to spawn the actor through it."""
    return vars(provider).get("_carla_actor_pool", {})
