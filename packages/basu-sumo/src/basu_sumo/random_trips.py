"""Random traffic: so many vehicles on random routes of any network, each replaced when it arrives."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

from basu.errors import UserError
from basu_sumo.trip_ends import Streets, is_in_sight

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from basu_sumo.link import Link

MIX = "traffic"  # the distribution of types in the folders of `linden map sumo`
FALLBACK = "DEFAULT_VEHTYPE"
ATTEMPTS = 50  # pairs of streets drawn for a vehicle until a route joins two
LEAST_EDGES = 3  # a route of fewer is no trip
Places = tuple[tuple[float, float], ...]


class RandomTrips:
    """Keeps ``count`` vehicles on the road. A vehicle in sight does not end its trip: see `trip_ends.TripEnds`."""

    def __init__(
        self,
        link: Link,
        count: int,
        seed: int,
        viewers: Callable[[], Places] = tuple,
        held: Callable[[], Collection[str]] = tuple,
    ) -> None:
        """Read the network's streets.

        ``viewers`` returns places in m: no vehicle begins in their sight. ``held`` returns vehicles that begin later
        (`trip_starts.TripStarts`). SUMO counts them as arrived.

        Raises:
            UserError: it has none that cars may begin at.
        """
        self._link, self._count, self._viewers, self._held = link, count, viewers, held
        self._dice = random.Random(seed)  # noqa: S311 - to be had again by its seed, not to be a secret
        self._number = 0
        self._alive: set[str] = set()
        self._streets = Streets(link)
        with link.answering("naming its types"):
            self._type = MIX if MIX in link.api.vehicletype.getIDList() else _mix_or_default(link)

    def fill(self) -> None:
        """Add a vehicle for each one that is missing."""
        with self._link.answering("adding a random trip"):
            self._alive -= set(self._link.api.simulation.getArrivedIDList()) - set(self._held())
            first = self._number == 0
            while len(self._alive) < self._count:
                route = self._route()
                if route is None:  # every street that was drawn is in sight: later
                    return
                self._add(route, anywhere=first)

    def _add(self, route: list[str], *, anywhere: bool) -> None:
        """Add one vehicle; ``anywhere`` on its route's first street, not only at its beginning."""
        api, name = self._link.api, f"random{self._number}"
        self._number += 1
        api.route.add(name, route)
        position = "random_free" if anywhere else "base"
        api.vehicle.add(name, name, typeID=self._type, departLane="best", departPos=position, departSpeed="max")
        self._alive.add(name)

    def _route(self) -> list[str] | None:
        """Return the edges of a route between two random streets; None where all that were drawn begin in sight.

        Raises:
            UserError: no pair that was drawn is joined.
        """
        places_m, is_hidden = self._viewers(), False
        for _ in range(ATTEMPTS):
            start, end = self._streets.draw(self._dice), self._streets.draw(self._dice)
            if is_in_sight(self._streets.beginning_m(start), places_m):
                continue
            is_hidden = True
            found = self._link.api.simulation.findRoute(start, end, FALLBACK)
            if len(found.edges) >= LEAST_EDGES:
                return list(found.edges)
        if not is_hidden:
            return None
        raise UserError(f"no two streets of SUMO's network are joined ({ATTEMPTS} pairs tried); check the network")


def _mix_or_default(link: Link) -> str:
    """Return the mix of types, which SUMO does not list among its types, where the scenario has it."""
    try:
        link.api.vehicle.add("probe", "", typeID=MIX, depart="1e6")
    except Exception:  # noqa: BLE001 - SUMO's error where there is no such distribution; its type differs by link
        return FALLBACK
    link.api.vehicle.remove("probe")
    return MIX
