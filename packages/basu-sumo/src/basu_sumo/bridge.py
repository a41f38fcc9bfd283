"""SUMO and a world of CARLA in step: CARLA's actors move in SUMO, SUMO steps, SUMO's road users are shown in CARLA."""

from __future__ import annotations

import contextlib
import math
from typing import TYPE_CHECKING, NamedTuple

from basu.errors import SimulatorError
from basu_sumo.display import Display
from basu_sumo.lights import Lights
from basu_sumo.mirrors import ROLE, Mirrors
from basu_sumo.models import Models
from basu_sumo.road_users import People, RoadUser, Vehicles
from basu_sumo.trip_ends import TripEnds
from basu_sumo.trip_starts import TripStarts

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable

    import carla

    from basu_sumo.link import Link

__all__ = ["ROLE", "Bridge", "Counts"]

LEVEL_M = 1.0  # a network has no heights of its own where they differ from the map's by more
PERSON = "person "  # before the names of people among all road users; SUMO's ids have no blanks


class Counts(NamedTuple):
    """What a bridge has seen so far."""

    departed: int  # vehicles that SUMO has put on the road
    shown: int  # actors that were spawned for vehicles and people
    waiting: int  # road users that stand where an actor cannot be spawned yet
    most: int  # vehicles on SUMO's roads at a time
    people: int = 0  # persons that have set out
    most_people: int = 0  # persons on foot at a time


class Bridge:
    """SUMO and a world of CARLA in step.

    The caller ticks the world: ``step`` once before each tick.
    """

    def __init__(
        self,
        link: Link,
        client: carla.Client,
        world: carla.World,
        carla_map: carla.Map,
        *,
        radius_m: float | None = None,
        lights: str = "carla",
    ) -> None:
        """Join both.

        ``radius_m`` shows road users only so near to the first mirrored vehicle. ``lights`` says which side has the
        lights: "carla", "sumo" or "none".
        """
        self.link, self._world = link, world
        self._radius_m, self._who_has_lights = radius_m, lights
        models = Models(world.get_blueprint_library())
        self.mirrors = Mirrors(link, world, models)
        self.vehicles, self.people = Vehicles(link, models), People(link, models)
        self.trip_ends = TripEnds(link)
        self.trip_starts = TripStarts(link, lambda: self.trip_ends.streets)
        self.display = Display(client, world, carla_map, radius_m)
        self.before_step: Callable[[], object] = lambda: None  # is called before each step of SUMO
        self._lights = None
        if lights != "none":
            self._lights = Lights(link, world.get_actors().filter("traffic.traffic_light"))
        if lights == "sumo":
            world.freeze_all_traffic_lights(True)

    @property
    def counts(self) -> Counts:
        """What has been seen so far."""
        display, vehicles, people = self.display, self.vehicles, self.people
        return Counts(
            vehicles.departed, display.shown, len(display.waiting), vehicles.most, people.departed, people.most
        )

    @property
    def actor_ids(self) -> dict[str, int]:
        """CARLA's actors by SUMO's vehicles."""
        return {name: actor for name, actor in self.display.actors.items() if not name.startswith(PERSON)}

    @property
    def walker_ids(self) -> dict[str, int]:
        """CARLA's walkers by SUMO's persons."""
        actors = self.display.actors.items()
        return {name.removeprefix(PERSON): actor for name, actor in actors if name.startswith(PERSON)}

    # -- does it fit?

    def misfit_m(self, places_m: Iterable[tuple[float, float, float]]) -> float:
        """How far the network's lanes lie from places in the middle of lanes: the median, inf where none is near.

        Notes as well whether the network has the map's heights.
        """
        away_m, rises_m = [], []
        api = self.link.api.simulation
        for x_m, y_m, z_m in places_m:
            at = (x_m + self.link.offset_m[0], -y_m + self.link.offset_m[1])
            try:
                edge, along_m, lane = api.convertRoad(*at, isGeo=False, vClass="passenger")
                near = api.convert3D(edge, along_m, lane)
            except Exception:  # noqa: BLE001 - SUMO's error where no road is near; its type differs by link
                away_m.append(math.inf)
                continue
            away_m.append(math.dist(at, near[:2]))
            rises_m.append(abs(near[2] - z_m))
        self.display.is_level = not rises_m or sorted(rises_m)[len(rises_m) // 2] < LEVEL_M
        return sorted(away_m)[len(away_m) // 2] if away_m else math.inf

    # -- a tick

    def step(self, snapshot: carla.WorldSnapshot, *, steps: int = 1) -> None:
        """Move CARLA's actors in SUMO, let SUMO make its steps, and show in CARLA where its road users are now.

        Raises:
            SimulatorError: SUMO or the simulator failed.
            UserError: a vehicle type cannot be shown.
        """
        users: dict[str, RoadUser] = {}
        for _ in range(steps):
            users = self._step_of_sumo(snapshot)
        if steps == 0:
            return
        try:
            self.mirrors.known.update(self.display.show(users, self._centre(snapshot)))
            if self._lights is not None and self._who_has_lights == "sumo":
                self._lights.to_carla()
        except RuntimeError as error:
            raise SimulatorError(f"the simulator failed at showing SUMO's traffic: {error}") from error

    def _step_of_sumo(self, snapshot: carla.WorldSnapshot) -> dict[str, RoadUser]:
        """One step of SUMO; its road users by their names."""
        self.before_step()
        with self.link.answering("moving CARLA's actors"):
            self.mirrors.move(snapshot, set(self.display.actors.values()))
        if self._lights is not None and self._who_has_lights == "carla":
            self._lights.to_sumo()
        self.link.step()
        with self.link.answering("letting trips begin"):
            held = self.trip_starts.look(self.mirrors.places_m)
        with self.link.answering("naming its road users"):
            people = {f"{PERSON}{name}": user for name, user in self.people.read().items()}
            vehicles = self.vehicles.read(held)
        with self.link.answering("prolonging trips"):
            self.trip_ends.look(vehicles, self.mirrors.places_m)
        return {**vehicles, **people}

    def viewers_m(self) -> tuple[tuple[float, float], ...]:
        """Return the places of the simulator's vehicles: no vehicle of SUMO begins or ends a trip in their sight."""
        return self.mirrors.places_m

    def held(self) -> Collection[str]:
        """Return the vehicles that wait to begin their trips out of sight."""
        return self.trip_starts.held

    def _centre(self, snapshot: carla.WorldSnapshot) -> carla.Location | None:
        """Return the middle of the circle in which road users are shown."""
        first = self.mirrors.first_id
        if self._radius_m is None or first is None:
            return None
        actor = snapshot.find(first)
        return None if actor is None else actor.get_transform().location

    # -- the end

    def close(self) -> None:
        """Take SUMO's traffic out of the world, give its lights back, and end SUMO; what is gone already is fine."""
        self.display.close()
        if self._who_has_lights == "sumo":
            with contextlib.suppress(RuntimeError):
                self._world.freeze_all_traffic_lights(False)
        self.link.close()
