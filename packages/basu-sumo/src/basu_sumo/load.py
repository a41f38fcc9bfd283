"""`Load` samples SUMO's traffic each simulated second (vehicles, halts, time loss) and counts arrivals and contacts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.records.history.sumo import Second
from basu_sumo.road_users import MIRROR

if TYPE_CHECKING:
    from collections.abc import Collection

    from basu_sumo.link import Link

HALTED_MPS = 0.1  # SUMO's own limit of a halt: microsim/MSGlobals, SUMO_const_haltingSpeed


class Load:
    """The seconds of a run so far, and the counts of the whole run."""

    def __init__(self, link: Link, step_s: float) -> None:
        """Begin to count; a row is taken every ``step_s``-th part of a second's steps."""
        self._link, self._every = link, max(1, round(1.0 / step_s))
        self._steps = 0
        self._last_s = 0.0
        self._contacts: set[tuple[str, str]] = set()
        self.seconds: list[Second] = []
        self.arrived = self.contacts = self.delayed = 0

    def tick(self, t_s: float, people: int, held: Collection[str] = ()) -> None:
        """Look at SUMO after a step. ``held`` are vehicles that begin later, which SUMO counts as arrived.

        Raises:
            SimulatorError: SUMO failed.
        """
        api = self._link.api
        with self._link.answering("naming its traffic"):
            arrived = [name for name in api.simulation.getArrivedIDList() if name not in held]
            self.arrived += sum(not name.startswith(MIRROR) for name in arrived)
            self._note_contacts()
            if self._steps % self._every == 0:
                self._note_second(t_s, people, len(held))
        self._steps += 1

    def _note_contacts(self) -> None:
        """Count each pair of SUMO's vehicles once for as long as it touches."""
        pairs = {
            (str(each.collider), str(each.victim))
            for each in self._link.api.simulation.getCollisions()
            if not each.collider.startswith(MIRROR) and not each.victim.startswith(MIRROR)
        }
        self.contacts += len(pairs - self._contacts)
        self._contacts = pairs

    def _note_second(self, t_s: float, people: int, held: int) -> None:
        """Add a row: speeds now stand for the time since the last row."""
        vehicle = self._link.api.vehicle
        names = [name for name in vehicle.getIDList() if not name.startswith(MIRROR)]
        speeds = [vehicle.getSpeed(name) for name in names]
        allowed = [vehicle.getAllowedSpeed(name) for name in names]
        since_s, self._last_s = t_s - self._last_s, t_s
        slower = sum(max(0.0, 1.0 - now / most) for now, most in zip(speeds, allowed, strict=True) if most > 0.0)
        halted = sum(speed < HALTED_MPS for speed in speeds)
        row = Second(t_s, len(names), people, halted, since_s * sum(speeds), since_s * slower)
        self.seconds.append(row)
        self.delayed = held + len(self._link.api.simulation.getPendingVehicles())
