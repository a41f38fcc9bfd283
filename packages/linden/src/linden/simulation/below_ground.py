"""Actors parked below the ground: they have no physics until a client puts them up again.

Programs hide actors so: those of ScenarioRunner wait for their scenario 500 m below the street. In CARLA they fall,
unless their physics is switched off; here there is ground everywhere, and it would lift them onto the street.
"""

import numpy as np
from numpy.typing import NDArray

from linden.maps.ground import Ground
from linden.physics.bodies import Bodies

DEEP_M = 10.0
"""No actor stands so far below the ground by mistake; roads under others have a ground of their own."""


class BelowGround:
    """The actors without physics, by the slots of their bodies."""

    def __init__(self, ground: Ground, bodies: Bodies) -> None:
        self._ground, self._bodies = ground, bodies
        self._withheld: set[int] = set()

    def arrive(self, slot: int) -> None:
        """Look where a new body is; its slot may have been another's."""
        self._withheld.discard(slot)
        self.settle(slot)

    def settle(self, slot: int) -> None:
        """Look where a body was put."""
        if self._is_deep(slot):
            if bool(self._bodies.simulate[slot]):
                self._bodies.set_simulate(slot, simulate=False)
                self._withheld.add(slot)
        elif slot in self._withheld:
            self._withheld.discard(slot)
            self._bodies.set_simulate(slot, simulate=True)

    def settle_all(self, slots: NDArray[np.integer]) -> None:
        """Look where many bodies were put."""
        places_m = self._bodies.position[slots]
        heights_m, _ = self._ground.surfaces_under(places_m)
        deep = places_m[:, 2] < heights_m - DEEP_M
        for slot in slots[deep | np.isin(slots, list(self._withheld))].tolist():
            self.settle(slot)

    def simulate(self, slot: int, *, wanted: bool) -> None:
        """Switch a body's physics; one that is buried gets it when it is put up."""
        is_deep = wanted and self._is_deep(slot)
        if is_deep:
            self._withheld.add(slot)
        else:
            self._withheld.discard(slot)
        self._bodies.set_simulate(slot, simulate=wanted and not is_deep)

    def _is_deep(self, slot: int) -> bool:
        place_m = self._bodies.position[slot]
        heights_m, _ = self._ground.surfaces_under(np.array([place_m]))
        return bool(place_m[2] < heights_m[0] - DEEP_M)
