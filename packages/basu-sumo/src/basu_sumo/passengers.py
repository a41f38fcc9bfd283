"""Passengers: SUMO's persons that wait for the vehicle under test, board while it serves a stop, and alight.

SUMO's own boarding needs a vehicle that SUMO drives. The vehicle under test is none. So a person that boards is taken
out of SUMO, and put back with the rest of its way where it alights.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from basu.metrics.passengers.service import CAPACITY, ONE_ALIGHTS_S, ONE_BOARDS_S
from basu.records.history.sumo import Passenger
from basu_sumo.road_users import STAGE_DRIVING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from basu_sumo.link import Link

LINE = "shuttle"  # of a person's ride in the demand: <ride lines="shuttle">


class _Rider(NamedTuple):
    """A passenger on board, with the rest of its way."""

    number: int  # in the list of passengers
    walks: tuple[tuple[tuple[str, ...], float], ...]  # edges and arrival position of each further walk
    type_id: str


class Passengers:
    """All that have waited for the vehicle under test, in the order of their coming."""

    def __init__(self, link: Link, stop_ids: Iterable[str]) -> None:
        """Look at the stops that SUMO's scenario knows by the route's names."""
        self._link = link
        with link.answering("naming its stops"):
            known = set(link.api.busstop.getIDList())
        self._stops = [stop_id for stop_id in stop_ids if stop_id in known]
        self._number: dict[str, int] = {}  # of each person in ``found``
        self._riders: list[_Rider] = []
        self._door_free_s = 0.0
        self.found: list[Passenger] = []

    def tick(self, t_s: float, served: str | None) -> None:
        """Take in persons that have come to a stop; at the ``served`` stop let persons alight and board.

        Raises:
            SimulatorError: SUMO failed.
        """
        with self._link.answering("naming its passengers"):
            for stop_id in self._stops:
                self._look(stop_id, t_s)
            if served is not None and served in self._stops and t_s >= self._door_free_s - 1e-6:
                self._serve(served, t_s)

    def _look(self, stop_id: str, t_s: float) -> None:
        """Note the persons that have come to a stop since the last tick."""
        for name in sorted(self._link.api.busstop.getPersonIDs(stop_id)):
            if name in self._number:
                continue
            stage = self._link.api.person.getStage(name, 0)
            if stage.type == STAGE_DRIVING and LINE in stage.line.split():
                self._number[name] = len(self.found)
                self.found.append(Passenger(name, stop_id, str(stage.destStop), t_s))

    def _serve(self, stop_id: str, t_s: float) -> None:
        """Let the next person through the door: those on board come first."""
        leaving = [rider for rider in self._riders if self.found[rider.number].destination_id == stop_id]
        if leaving:
            self._alight(leaving[0], stop_id, t_s)
            self._door_free_s = t_s + ONE_ALIGHTS_S
            return
        waiting = [
            passenger
            for passenger in self.found
            if passenger.stop_id == stop_id and passenger.boarded_s is None and passenger.destination_id != stop_id
        ]
        if waiting and len(self._riders) < CAPACITY:
            self._board(waiting[0], t_s)
            self._door_free_s = t_s + ONE_BOARDS_S

    def _board(self, passenger: Passenger, t_s: float) -> None:
        """Take a person out of SUMO; it keeps the rest of its way."""
        person = self._link.api.person
        stages: list[Any] = [
            person.getStage(passenger.name, nth) for nth in range(1, person.getRemainingStages(passenger.name))
        ]
        walks = tuple((tuple(stage.edges), float(stage.arrivalPos)) for stage in stages if stage.edges)
        number = self._number[passenger.name]
        self._riders.append(_Rider(number, walks, str(person.getTypeID(passenger.name))))
        person.remove(passenger.name)
        self.found[number] = passenger._replace(boarded_s=t_s)

    def _alight(self, rider: _Rider, stop_id: str, t_s: float) -> None:
        """Put a person back into SUMO beside the stop, with the rest of its way."""
        api, passenger = self._link.api, self.found[rider.number]
        self._riders.remove(rider)
        self.found[rider.number] = passenger._replace(alighted_s=t_s)
        if not rider.walks:
            return
        edge = str(api.busstop.getLaneID(stop_id)).rpartition("_")[0]
        api.person.add(passenger.name, edge, float(api.busstop.getStartPos(stop_id)), typeID=rider.type_id)
        for edges, end_m in rider.walks:
            api.person.appendWalkingStage(passenger.name, list(edges), end_m)
