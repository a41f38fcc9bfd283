"""SUMO's traffic in a run: chooses the scenario, joins SUMO and the world, lets both go on in step."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from basu.errors import SimulatorError, UserError
from basu.managers.base_manager import BaseManager
from basu.sumo.bridge import Bridge
from basu.sumo.link import Link, connected, in_process
from basu.sumo.random_trips import RandomTrips
from basu.sumo.scenario import config_in, made_of, named_folder

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.managers.base_manager import Frame, Run, WorldChanges
    from basu.options import Sumo

MISFIT_M = 4.0  # from the route to the middle of SUMO's lanes: a lane's width, which is the next lane's
PLACES = 20  # of the route, that a network is tried on


class SumoManager(BaseManager):
    """SUMO beside the world. ``count`` says how many of its vehicles were shown."""

    def __init__(self, sumo: Sumo, linden: Sequence[str]) -> None:
        """Note what is to be run; ``linden`` is the command that makes a network of a map."""
        self._sumo, self._linden = sumo, linden
        self._bridge: Bridge | None = None
        self._trips: RandomTrips | None = None
        self._changes: WorldChanges | None = None
        self.count = 0

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
        if self._sumo.is_random:
            self._trips = RandomTrips(link, self._sumo.vehicles, run.seed)
            self._trips.fill()
        self._changes = run.changes
        bridge.step(run.world.get_snapshot())

    def _start(self, run: Run) -> Link:
        """A SUMO that has loaded the scenario of this run."""
        if self._sumo.port is not None:
            return connected("127.0.0.1", self._sumo.port, step_s=run.step_s)
        return in_process(self._config(run), step_s=run.step_s, seed=run.seed)

    def _config(self, run: Run) -> Path:
        """The .sumocfg that was named, or that of the agent's folder, or that of the town."""
        if self._sumo.file is not None:
            return self._sumo.file
        folder = None
        if self._sumo.folder is not None:
            folder = named_folder(self._sumo.folder, run.route.town, self._sumo.beside)
        if folder is None:
            folder = made_of(run.carla_map.to_opendrive(), run.route.town, run.seed, self._linden)
        return config_in(folder, is_random=self._sumo.is_random)

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
        if self._bridge is not None:
            if self._trips is not None:
                self._trips.fill()
            before = set(self._bridge.actor_ids.values())
            self._bridge.step(frame.snapshot)
            now = set(self._bridge.actor_ids.values())
            if self._changes is not None:  # what SUMO moves and takes away is not the agent's doing
                self._changes.placed |= now | before
                self._changes.removed |= before - now
                self._changes.lights += self._sumo.lights == "sumo"

    def close(self) -> None:
        """Take SUMO's vehicles away and end SUMO."""
        if self._bridge is not None:
            self.count = self._bridge.counts.shown
            self._bridge.close()
        self._bridge = self._trips = None
