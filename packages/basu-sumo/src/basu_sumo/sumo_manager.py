"""`SumoManager`: co-simulation with SUMO; selects its .sumocfg, starts it, steps both, and counts bus passengers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.errors import SimulatorError, UserError
from basu.managers.base_manager import CoSimulation
from basu.metrics.path_following import serves
from basu.records.history.sumo import SumoRecord
from basu_sumo.bridge import Bridge
from basu_sumo.link import Link, connected, in_process
from basu_sumo.load import Load
from basu_sumo.outputs import Outputs
from basu_sumo.passengers import Passengers
from basu_sumo.random_trips import RandomTrips
from basu_sumo.road_users import MIRROR
from basu_sumo.scenario import DEFAULT_HOUR, RouteStop, Wanted, config_in, made_of, named_folder

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from basu.conditions import Sumo
    from basu.managers.base_manager import Frame, Run
    from basu.managers.routes_manager import RoutesManager

MISFIT_M = 4.0  # from the route to the middle of SUMO's lanes: a lane's width, which is the next lane's
PLACES = 20  # of the route, that a network is tried on
S_PER_HOUR = 3600.0


class SumoManager(CoSimulation):
    """SUMO beside the world. ``count`` says how many of its vehicles and people there were."""

    def __init__(self, sumo: Sumo, linden: Sequence[str], routes: RoutesManager) -> None:
        """Note what is to be run; ``linden`` is the command that makes a network of a map."""
        self._sumo, self._linden, self._routes = sumo, linden, routes
        self._bridge: Bridge | None = None
        self._outputs = Outputs(None, "")
        self.count = {"vehicles": 0, "walkers": 0}

    def setup(self, run: Run) -> None:
        """Start SUMO, check that its network is the town's, and show its first vehicles.

        Raises:
            UserError: SUMO is not installed, or its scenario cannot be used here.
            SimulatorError: SUMO or the simulator failed.
        """
        link = self._start(run)
        try:
            radius_m, lights = self._sumo.radius_m, self._sumo.lights
            bridge = Bridge(link, run.client, run.world, run.carla_map, radius_m=radius_m, lights=lights)
        except BaseException as error:
            link.close()
            if isinstance(error, RuntimeError):
                raise SimulatorError(f"the simulator failed at joining SUMO: {error}") from error
            raise
        self._bridge = bridge
        self._check(bridge, run)
        self._step_s, self._stops = run.step_s, run.route.stops
        if self._sumo.is_random:
            bridge.before_step = RandomTrips(link, self._sumo.vehicles, run.seed, bridge.viewers_m, bridge.held).fill
        boarded = [stop.id for stop in self._stops] if self._sumo.has_riders else []
        self._load, self._passengers = Load(link, run.step_s), Passengers(link, boarded)
        bridge.step(run.world.get_snapshot())

    def _start(self, run: Run) -> Link:
        """A SUMO that has loaded the scenario of this run."""
        if self._sumo.port is not None:
            return connected("127.0.0.1", self._sumo.port, step_s=run.step_s)
        config = self._config(run)
        self._outputs = Outputs(run.folder if self._sumo.has_output else None, f"{MIRROR}{run.vehicle.id}")
        more = [*self._outputs.options]
        if self._sumo.scale is not None and self._sumo.file is not None:
            more += ["--scale", f"{self._sumo.scale:g}"]
        return in_process(config, step_s=run.step_s, seed=run.seed, more=more)

    def _config(self, run: Run) -> Path:
        """The .sumocfg that was named, or that of the agent's folder, or that of the town.

        Raises:
            UserError: there is none, or it has a demand of its own beside a wish for another one.
        """
        if self._sumo.file is not None:
            return self._sumo.file
        folder = None
        if self._sumo.folder is not None:
            folder = named_folder(self._sumo.folder, run.route.town, self._sumo.beside)
        if folder is None:
            folder = made_of(run.carla_map.to_opendrive(), run.route.town, run.seed, self._linden, self._wanted(run))
        elif self._sumo.hour is not None or self._sumo.scale is not None:
            raise UserError(
                f"the agent's SUMO folder {folder} has a demand of its own hour and scale; leave out --sumo-hour and "
                "--sumo-scale, or write another folder with `linden map sumo`"
            )
        return config_in(folder, is_random=self._sumo.is_random)

    def _wanted(self, run: Run) -> Wanted:
        """The demand of this run: that of the hour that it stands for, with the route's stops."""
        timetable = run.route.timetable
        places: dict[tuple[float, float], RouteStop] = {}  # a route of several rounds has each stop once a round
        for stop in run.route.stops:
            places.setdefault((stop.x_m, stop.y_m), RouteStop(stop.id, stop.name, stop.x_m, stop.y_m))
        hour = DEFAULT_HOUR if timetable is None else timetable.run_departure_s / S_PER_HOUR
        return Wanted(
            hour=hour if self._sumo.hour is None else self._sumo.hour,
            scale=1.0 if self._sumo.scale is None else self._sumo.scale,
            stops=tuple(places.values()),
            has_riders=self._sumo.has_riders,
        )

    def _check(self, bridge: Bridge, run: Run) -> None:
        """Check that the network is that of the town.

        Raises:
            UserError: it is another town's, or lies elsewhere.
        """
        points_m = run.route.points_m[:: max(1, len(run.route.points_m) // PLACES)]
        away_m = bridge.misfit_m([(float(x), float(y), float(z)) for x, y, z in points_m])
        if away_m > MISFIT_M:
            said = "has no road near it" if away_m == float("inf") else f"lies {away_m:.0f} m away from it"
            raise UserError(
                f"SUMO's network is not that of {run.route.town}: route '{run.route.id}' was tried, and the network "
                f"{said}; it is of another town, or its offset is wrong: make one with "
                f"`linden map sumo {run.route.town} -o net/`"
            )

    def tick(self, frame: Frame) -> None:
        """Let SUMO make its part of the next step; called before the world makes its own.

        Raises:
            SimulatorError: SUMO failed or died.
        """
        bridge = self._bridge
        if bridge is None:
            return
        t_s = frame.tick * self._step_s
        self._passengers.tick(t_s, self._served(frame))
        bridge.step(frame.snapshot)
        self._load.tick(t_s + self._step_s, bridge.people.present, bridge.held())

    def _served(self, frame: Frame) -> str | None:
        """The stop that the vehicle under test serves in this frame."""
        if not self._routes.valid.check.valid:
            return None
        s_m, speed_mps = self._routes.progress.s_m, frame.ego.speed_mps
        return next((stop.id for stop in self._stops if serves(stop.s_m - s_m, speed_mps)), None)

    def record(self) -> SumoRecord | None:
        """SUMO's part of the record until now; None where it has not begun."""
        if self._bridge is None:
            return None
        counts = self._bridge.counts
        return SumoRecord(
            departed=counts.departed,
            arrived=self._load.arrived,
            delayed=self._load.delayed,
            hidden=counts.waiting,
            people=counts.people,
            contacts=self._load.contacts,
            seconds=tuple(self._load.seconds),
            passengers=tuple(self._passengers.found),
        )

    def close(self) -> None:
        """Take SUMO's vehicles away and end SUMO."""
        if self._bridge is not None:
            counts = self._bridge.counts
            self.count = {"vehicles": counts.departed, "walkers": counts.people}
            self._bridge.close()
            self._outputs.finish()
        self._bridge = None
