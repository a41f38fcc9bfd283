"""Look-ups in the running world and its clock, as ScenarioRunner's ``CarlaDataProvider`` and ``GameTime`` give them."""

from __future__ import annotations

import datetime as dt
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn

import carla

if TYPE_CHECKING:
    from collections.abc import ItemsView


TRAFFIC_MANAGER_PORT = 8000  # CARLA's usual one
HERO = "hero"


class _Surface(type):
    """Refuse what only ScenarioRunner has."""

    def __getattr__(cls, name: str) -> NoReturn:
        raise AttributeError(
            f"CarlaDataProvider.{name} is not among the look-ups that BASU brings; put ScenarioRunner's folder and "
            "CARLA's PythonAPI/carla on PYTHONPATH, and theirs is used"
        )


class CarlaDataProvider(metaclass=_Surface):
    """The world of the run. BASU sets it before an agent is made and takes it away after the run.

    Where ScenarioRunner remembers what it registered, this asks the simulator: the answers are those of the last step.
    """

    _client: ClassVar[carla.Client | None] = None
    _world: ClassVar[carla.World | None] = None
    _map: ClassVar[carla.Map | None] = None
    _actors: ClassVar[dict[int, carla.Actor]] = {}
    _ego_route: ClassVar[Any] = None
    _all_actors: ClassVar[carla.ActorList | None] = None

    @staticmethod
    def set_client(client: carla.Client) -> None:
        """Take the client of the run."""
        CarlaDataProvider._client = client

    @staticmethod
    def get_client() -> carla.Client | None:
        """The client that BASU is connected with."""
        return CarlaDataProvider._client

    @staticmethod
    def set_world(world: carla.World) -> None:
        """Take the world of the run."""
        CarlaDataProvider._world = world
        CarlaDataProvider._map = world.get_map()

    @staticmethod
    def get_world() -> carla.World | None:
        """The world of the run; None where there is none."""
        return CarlaDataProvider._world

    @staticmethod
    def get_map(world: carla.World | None = None) -> carla.Map:
        """The map of the run, which is read once."""
        if CarlaDataProvider._map is None:
            wanted = world or CarlaDataProvider._world
            if wanted is None:
                raise ValueError("CarlaDataProvider has no world yet")
            CarlaDataProvider._map = wanted.get_map()
        return CarlaDataProvider._map

    @staticmethod
    def get_blueprint_library() -> carla.BlueprintLibrary:
        """The blueprints of the simulator."""
        return _needed(CarlaDataProvider._world).get_blueprint_library()

    @staticmethod
    def is_sync_mode() -> bool:
        """Whether the world is ticked by a client: in a BASU run it is."""
        return bool(_needed(CarlaDataProvider._world).get_settings().synchronous_mode)

    @staticmethod
    def register_actor(actor: carla.Actor, transform: carla.Transform | None = None) -> None:
        """Remember an actor under its id; ``transform`` is where it stands, which is not needed here."""
        del transform
        CarlaDataProvider._actors[actor.id] = actor

    @staticmethod
    def get_actors() -> ItemsView[int, carla.Actor]:
        """Ids and actors that were registered: the vehicle under test."""
        return CarlaDataProvider._actors.items()

    @staticmethod
    def get_all_actors() -> carla.ActorList:
        """All actors in the world; read once a step."""
        if CarlaDataProvider._all_actors is None:
            CarlaDataProvider._all_actors = _needed(CarlaDataProvider._world).get_actors()
        return CarlaDataProvider._all_actors

    @staticmethod
    def get_actor_by_id(actor_id: int) -> carla.Actor | None:
        """A registered actor; None where there is none."""
        return CarlaDataProvider._actors.get(actor_id)

    @staticmethod
    def actor_id_exists(actor_id: int) -> bool:
        """Whether an actor of that id is registered."""
        return actor_id in CarlaDataProvider._actors

    @staticmethod
    def get_actor_by_name(role_name: str) -> carla.Actor | None:
        """The first registered actor of a role; None where there is none."""
        named = (
            actor for actor in CarlaDataProvider._actors.values() if actor.attributes.get("role_name") == role_name
        )
        return next(named, None)

    @staticmethod
    def get_hero_actor() -> carla.Actor | None:
        """The vehicle under test; None before and after a run."""
        return CarlaDataProvider.get_actor_by_name(HERO)

    @staticmethod
    def get_velocity(actor: carla.Actor) -> float:
        """The speed of an actor in m/s."""
        return float(actor.get_velocity().length())

    @staticmethod
    def get_location(actor: carla.Actor) -> carla.Location:
        """Where an actor is."""
        return actor.get_location()

    @staticmethod
    def get_transform(actor: carla.Actor) -> carla.Transform:
        """Where an actor is and how it is turned."""
        return actor.get_transform()

    @staticmethod
    def set_ego_route(route: Any) -> None:  # noqa: ANN401 - a list of (transform, option), kept as it is
        """Take the dense plan of the run."""
        CarlaDataProvider._ego_route = route

    @staticmethod
    def get_ego_route() -> Any:  # noqa: ANN401 - as above
        """The dense plan of the run, a list of (transform, option)."""
        return CarlaDataProvider._ego_route

    @staticmethod
    def get_traffic_manager_port() -> int:
        """Where a Traffic Manager of the agent's own would be reached."""
        return TRAFFIC_MANAGER_PORT

    @staticmethod
    def on_carla_tick() -> None:
        """Forget the answers of the last step."""
        CarlaDataProvider._all_actors = None

    @staticmethod
    def cleanup() -> None:
        """Forget the run."""
        CarlaDataProvider._client = CarlaDataProvider._world = CarlaDataProvider._map = None
        CarlaDataProvider._ego_route = CarlaDataProvider._all_actors = None
        CarlaDataProvider._actors = {}


def _needed(world: carla.World | None) -> carla.World:
    if world is None:
        raise ValueError("CarlaDataProvider has no world yet")
    return world


class GameTime:
    """Simulated time since the run began; BASU lets it go on before each step of the agent."""

    _time_s: ClassVar[float] = 0.0
    _carla_time_s: ClassVar[float] = 0.0
    _frame: ClassVar[int] = 0
    _wall: ClassVar[dt.datetime | None] = None

    @staticmethod
    def on_carla_tick(timestamp: carla.Timestamp) -> None:
        """Go on to a step of the simulator; one that is not newer changes nothing."""
        if timestamp.frame <= GameTime._frame:
            return
        steps = timestamp.frame - GameTime._frame if GameTime._frame else 1
        GameTime._time_s += timestamp.delta_seconds * steps
        GameTime._carla_time_s = timestamp.elapsed_seconds
        GameTime._frame = timestamp.frame
        GameTime._wall = dt.datetime.now()  # noqa: DTZ005 - agents subtract it from others without a zone

    @staticmethod
    def restart() -> None:
        """Begin anew."""
        GameTime._time_s = GameTime._carla_time_s = 0.0
        GameTime._frame = 0
        GameTime._wall = None

    @staticmethod
    def get_time() -> float:
        """Simulated time in s since the run began; one step at the first call of ``run_step``."""
        return GameTime._time_s

    @staticmethod
    def get_carla_time() -> float:
        """Simulated time in s since the simulator's episode began."""
        return GameTime._carla_time_s

    @staticmethod
    def get_wallclocktime() -> dt.datetime | None:
        """When the last step was heard of; None before the first."""
        return GameTime._wall

    @staticmethod
    def get_frame() -> int:
        """The simulator's number of the last step."""
        return GameTime._frame
