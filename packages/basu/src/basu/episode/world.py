"""The world of an episode: its town with lanes, its clock, its weather, and a vehicle under test at its start."""

from __future__ import annotations

import contextlib
import difflib
from typing import TYPE_CHECKING, NamedTuple

import carla

from basu.errors import AgentCrashedError, SimulatorError, UserError
from basu.managers.base_manager import Frame, ego_in
from basu.managers.conduct import ticked
from basu.routing import lane_graph
from basu.simulator import reason

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator

    from basu.managers.base_manager import Run
    from basu.routing import Route
    from basu.routing.lane_graph import LaneGraph, Street
    from basu.simulator import Simulator

DROP_M = 0.3  # above the road, so that no wheel begins inside of it
SETTLE_TICKS = 20  # from the drop to rest


@contextlib.contextmanager
def asking(what: str) -> Iterator[None]:
    """Turn the errors of the client into the simulator's failure at ``what``.

    Raises:
        SimulatorError: the client raised what the simulator said.
    """
    try:
        yield
    except RuntimeError as error:
        raise SimulatorError(f"the simulator failed at {what}: {reason(error)}") from error


class Town(NamedTuple):
    """A town's map and its lanes. The client takes 0.4 s to read the map of Linden again, as long as a short drive."""

    carla_map: carla.Map
    lanes: LaneGraph
    streets: list[Street]  # the lanes' centre lines


class Towns:
    """The towns of one simulator. Each is read once, where no other program can change it meanwhile."""

    def __init__(self, simulator: Simulator) -> None:
        """Read no town yet."""
        self._simulator = simulator
        self._read: dict[str, Town] = {}
        self._loaded: str | None = None  # the town that we have loaded last

    def names(self, wanted: Collection[str]) -> frozenset[str]:
        """Return the names of the simulator's towns as far as it takes to find ``wanted`` among them.

        Raises:
            SimulatorError: the simulator does not answer.
        """
        with asking("naming its towns"):
            return towns_of(self._simulator, wanted)

    def load(self, name: str, *, reload: bool | None = None) -> tuple[carla.World, Town]:
        """Return the world with the town ``name`` in it, and the town.

        ``reload`` begins the world anew. By default a simulator of our own does so from its second episode on.
        Another one never does: its world may hold other programs' actors.

        Raises:
            SimulatorError: the simulator does not load it.
        """
        client, own = self._simulator.client, self._simulator.own
        again = reload if reload is not None else own and self._loaded is not None
        with asking(f"loading {name}"), self._simulator.long_call():
            if again:
                client.reload_world(reset_settings=False)
            known = self._loaded == name and (own or again)
            self._loaded = name
            if known and name in self._read:
                return client.get_world(), self._read[name]
            world, carla_map = world_with(self._simulator, name)
            lanes = lane_graph.build(carla_map)
            self._read[name] = Town(carla_map, lanes, lanes.streets())
        return world, self._read[name]


def check_towns(names: frozenset[str], wanted: Iterable[str]) -> None:
    """Check that a simulator with the towns ``names`` has all ``wanted``, before an episode begins in one of them.

    Raises:
        UserError: it lacks one.
    """
    missing = sorted(set(wanted) - names)
    if missing:
        where = f"the route is in {missing[0]}" if len(missing) == 1 else f"routes are in {', '.join(missing)}"
        raise UserError(
            f"{where}, which this simulator does not have; it has {', '.join(sorted(names))}: "
            "name another file with --routes, or choose routes with --routes-subset"
        )


def towns_of(simulator: Simulator, wanted: Collection[str]) -> frozenset[str]:
    """Return the towns that a simulator has: those it offers, the one that BASU sent, and the loaded one.

    The name of the loaded one stands in its map, which the client reads in 0.3 s. So it is left out where the others
    hold all that are ``wanted``.
    """
    client = simulator.client
    names = frozenset(map(_short, client.get_available_maps()))
    if simulator.uploaded is not None:
        names |= {simulator.uploaded}
    return names if names.issuperset(wanted) else names | {_short(client.get_world().get_map().name)}


def world_with(simulator: Simulator, town: str) -> tuple[carla.World, carla.Map]:
    """Return the world with ``town`` in it, loaded where another one is, and its map.

    The client reads the map again at a second call of ``get_map``, so there is one.
    """
    client, name = simulator.client, simulator.map_name(town)
    world = client.get_world()
    carla_map = world.get_map()
    if _short(carla_map.name) != name:
        world = client.load_world(name, reset_settings=False)
        carla_map = world.get_map()
    return world, carla_map


def _short(map_name: str) -> str:
    """The last part of a map's name: `Linden` of `Carla/Maps/Linden`."""
    return map_name.rsplit("/", maxsplit=1)[-1]


@contextlib.contextmanager
def ticked_by_us(world: carla.World, step_s: float) -> Iterator[None]:
    """Set synchronous mode with a fixed step; the settings that were there before come back afterwards."""
    before = world.get_settings()
    settings = world.get_settings()
    settings.synchronous_mode = True
    settings.fixed_delta_seconds = step_s
    world.apply_settings(settings)
    try:
        yield
    finally:
        with contextlib.suppress(RuntimeError):  # where the simulator is gone, so are its settings
            world.apply_settings(before)


def weather_called(name: str) -> carla.WeatherParameters:
    """One of CARLA's presets by its name.

    Raises:
        UserError: there is none of that name.
    """
    presets = {
        key: value for key, value in vars(carla.WeatherParameters).items() if isinstance(value, carla.WeatherParameters)
    }
    if name not in presets:
        raise UserError(f"there is no weather called '{name}'; there are {', '.join(sorted(presets))}")
    return presets[name]


@contextlib.contextmanager
def spawned_at_start(world: carla.World, route: Route, blueprint_id: str, role: str) -> Iterator[carla.Vehicle]:
    """Spawn a vehicle above the first point of ``route`` with its brake on, and destroy it afterwards.

    Raises:
        UserError: there is no such vehicle, or the place is taken.
    """
    blueprint = _blueprint(world.get_blueprint_library(), blueprint_id)
    blueprint.set_attribute("role_name", role)
    pose = route.waypoints[0].transform
    pose.location.z += DROP_M
    try:
        vehicle = world.spawn_actor(blueprint, pose)
    except RuntimeError as error:
        raise UserError(f"{blueprint_id} cannot be put at the beginning of route '{route.id}': {error}") from error
    try:
        vehicle.apply_control(carla.VehicleControl(brake=1.0))
        yield vehicle
    finally:
        with contextlib.suppress(RuntimeError):  # where the simulator is gone, so is the vehicle
            vehicle.destroy()


def settle(world: carla.World) -> None:
    """Let vehicles that were just spawned come to rest."""
    for _ in range(SETTLE_TICKS):
        world.tick()


def _blueprint(library: carla.BlueprintLibrary, blueprint_id: str) -> carla.ActorBlueprint:
    """A vehicle's blueprint by its whole id."""
    known = [blueprint.id for blueprint in library.filter("vehicle.*")]
    if blueprint_id not in known:
        close = difflib.get_close_matches(blueprint_id, known, 1)
        hint = f"did you mean '{close[0]}'?" if close else f"it has {', '.join(sorted(known))}"
        raise UserError(f"the simulator has no vehicle '{blueprint_id}'; {hint}")
    return library.find(blueprint_id)


def next_snapshot(run: Run, before: carla.WorldSnapshot | None) -> carla.WorldSnapshot:
    """Let the simulator make one step and read its snapshot; ``before`` is the one of the step before.

    Raises:
        AgentCrashedError: there was another step, in a simulator of our own.
        UserError: likewise, in another one.
        SimulatorError: the simulator made none.
    """
    try:
        number = run.world.tick(run.timeout_s)
        snapshot = run.world.get_snapshot()
    except RuntimeError as error:
        raise SimulatorError(f"the simulator did not make a step: {reason(error)}") from error
    if before is None or snapshot.frame == before.frame + 1:
        return snapshot
    if run.own_simulator:
        raise AgentCrashedError(ticked("the agent", before.frame, snapshot.frame))
    raise UserError(
        f"the simulator went from frame {before.frame} to {snapshot.frame} (requested: {number}); "
        "another program ticks it too, and a benchmark has to be the only one"
    )


def frame_in(snapshot: carla.WorldSnapshot, tick: int, run: Run) -> Frame:
    """Return the frame of a vehicle under test in a snapshot.

    Raises:
        AgentCrashedError: the vehicle is gone, in a simulator of our own.
        SimulatorError: likewise, in another one.
    """
    ego = snapshot.find(run.vehicle.id)
    if ego is not None:
        return Frame(tick, snapshot.frame, snapshot, ego_in(ego))
    if run.own_simulator:
        raise AgentCrashedError(f"the agent took the vehicle under test out of the world before frame {snapshot.frame}")
    raise SimulatorError(f"the vehicle under test is gone from the world in frame {snapshot.frame}")
