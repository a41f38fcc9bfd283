"""``complete_claims``: the ``right_of_way`` elements of a junction, each with the lanelets that yield.

Autoware leaves the yielding lanelets of the element out of what a vehicle on the lanelet watches. Its requirements
(vm-03-10 and vm-03-11 of the map requirements of pilot-auto, as autoware_lanelet2_map_validator tests them) want

- without lights: an element only where every way that is met yields, and then all of these ways;
- before lights: an element for each way that turns, with the ways that a light holds meanwhile;
- one element at least in each junction.
"""

import math
from itertools import combinations

from linden.maps.opendrive.evaluate.pieces import F64
from linden_maps.lanelet2.movements import Movement
from linden_maps.lanelet2.overlap import area_m2, overlap_m2

MET_SHARE = 0.01
"""Ways meet where so much of a lanelet lies on the other; the validator leaves out less."""
_LAYER_M = 3.0
_ACROSS = math.cos(math.radians(45.0))

Claims = dict[int, list[int]]
"""By way (stretch): the ways that yield to it."""


def complete_claims(
    movements: list[Movement], rings: dict[int, F64], waiting: dict[int, list[int]], lit: frozenset[int]
) -> Claims:
    """Return the elements of a junction as Autoware wants them.

    ``rings`` are the lanelets' outlines (N, 2) by stretch, ``waiting`` the ways that yield to each way, ``lit`` the
    ways that a light governs.
    """
    met = _met(movements, rings)
    claims: Claims = {}
    for way in movements:
        against, yielding = met[way.stretch], set(waiting.get(way.stretch, ()))
        if way.stretch in lit:
            held = [other.stretch for other in against if _is_held(way, other, lit) and other.stretch in yielding]
            if held:  # Lanelet2 refuses an element that names none
                claims[way.stretch] = held
        elif against and all(other.stretch in yielding for other in against):
            claims[way.stretch] = [other.stretch for other in against]
    return claims or _nominal(movements, met)


def _nominal(movements: list[Movement], met: dict[int, list[Movement]]) -> Claims:
    """Return one element for a junction where none is complete: of a way that meets no other, so it changes nothing."""
    for way in movements:
        others = [other.stretch for other in movements if not way.origins & other.origins]
        if others and not met[way.stretch]:
            return {way.stretch: others[:1]}
    return {}


def _met(movements: list[Movement], rings: dict[int, F64]) -> dict[int, list[Movement]]:
    """Return the ways that each way meets; ways that part at a common lane do not meet."""
    met: dict[int, list[Movement]] = {way.stretch: [] for way in movements}
    areas_m2 = {stretch: area_m2(ring) for stretch, ring in rings.items()}
    for way, other in combinations(movements, 2):
        is_near = abs(float(way.line[:, 2].mean() - other.line[:, 2].mean())) < _LAYER_M
        if way.origins & other.origins or not is_near:
            continue
        shared_m2 = overlap_m2(rings[way.stretch], rings[other.stretch])
        for one, against in ((way, other), (other, way)):
            if shared_m2 > 0.0 and shared_m2 >= MET_SHARE * areas_m2[one.stretch]:
                met[one.stretch].append(against)
    return met


def _is_held(way: Movement, other: Movement, lit: frozenset[int]) -> bool:
    """Return whether a light holds the other meanwhile, as the validator takes it: lights across show other colours."""
    if other.stretch not in lit:
        return True
    is_across = abs(math.cos(way.heading_rad - other.heading_rad)) <= _ACROSS
    return is_across or (way.direction == "left" and other.direction == "right")
