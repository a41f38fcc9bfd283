"""Random traffic: so many vehicles on random routes of any network, each replaced when it arrives."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

from basu.errors import UserError

if TYPE_CHECKING:
    from basu.sumo.link import Link

MIX = "traffic"  # the distribution of types in the folders of `linden map sumo`
FALLBACK = "DEFAULT_VEHTYPE"
ATTEMPTS = 50  # pairs of streets drawn for a vehicle until a route joins two
LEAST_EDGES = 3  # a route of fewer is no trip


class RandomTrips:
    """Keeps ``count`` vehicles on the road."""

    def __init__(self, link: Link, count: int, seed: int) -> None:
        """Read the network's streets.

        Raises:
            UserError: it has none that cars may begin at.
        """
        self._link, self._count = link, count
        self._dice = random.Random(seed)  # noqa: S311 - to be had again by its seed, not to be a secret
        self._number = 0
        self._alive: set[str] = set()
        with link.answering("naming its streets"):
            api = link.api
            edges = sorted(edge for edge in api.edge.getIDList() if not edge.startswith(":"))
            self._edges = [edge for edge in edges if _for_cars(api, edge)]
            self._lengths_m = [api.lane.getLength(f"{edge}_0") for edge in self._edges]
            self._type = MIX if MIX in api.vehicletype.getIDList() else _mix_or_default(link)
        if not self._edges:
            raise UserError("SUMO's network has no street for cars; make one with `linden map sumo`")

    def fill(self) -> None:
        """Add a vehicle for each one that is missing."""
        with self._link.answering("adding a random trip"):
            self._alive -= set(self._link.api.simulation.getArrivedIDList())
            first = self._number == 0
            while len(self._alive) < self._count:
                self._add(anywhere=first)

    def _add(self, *, anywhere: bool) -> None:
        """Add one vehicle; ``anywhere`` on its route's first street, not only at its beginning."""
        api, name = self._link.api, f"random{self._number}"
        self._number += 1
        route = self._route()
        api.route.add(name, route)
        position = "random_free" if anywhere else "base"
        api.vehicle.add(name, name, typeID=self._type, departLane="best", departPos=position, departSpeed="max")
        self._alive.add(name)

    def _route(self) -> list[str]:
        """The edges of a route between two random streets.

        Raises:
            UserError: no pair that was drawn is joined.
        """
        for _ in range(ATTEMPTS):
            start, end = self._dice.choices(self._edges, self._lengths_m, k=2)
            found = self._link.api.simulation.findRoute(start, end, FALLBACK)
            if len(found.edges) >= LEAST_EDGES:
                return list(found.edges)
        raise UserError(f"no two streets of SUMO's network are joined ({ATTEMPTS} pairs tried); check the network")


def _for_cars(api: object, edge: str) -> bool:
    lane_api, count = api.lane, api.edge.getLaneNumber(edge)  # type: ignore[attr-defined]
    return any(_allows(lane_api.getAllowed(f"{edge}_{nth}"), lane_api.getDisallowed(f"{edge}_{nth}"))
               for nth in range(count))  # fmt: skip


def _allows(allowed: tuple[str, ...], disallowed: tuple[str, ...]) -> bool:
    return "passenger" in allowed if allowed else "passenger" not in disallowed and "all" not in disallowed


def _mix_or_default(link: Link) -> str:
    """The mix of types, which SUMO does not list among its types, where the scenario has it."""
    try:
        link.api.vehicle.add("probe", "", typeID=MIX, depart="1e6")
    except Exception:  # noqa: BLE001 - SUMO's error where there is no such distribution; its type differs by link
        return FALLBACK
    link.api.vehicle.remove("probe")
    return MIX
