"""``home``: the South Linden scene: houses, yards, trees, lamps, poles, shelters, cars and buildings; no signals."""

from linden.maps.facts import MapFacts
from linden.scenery.scene.kerb_parking import kerbside_cars
from linden.scenery.scene.linden_survey import surveyed
from linden.scenery.scene.mapped import beside_buildings, kept, mapped
from linden.scenery.scene.neighbourhood import furnish, with_taken
from linden.scenery.scene.objects import Scene, join
from linden.scenery.scene.utility_poles import clear_of, poles, shelters
from linden.scenery.scene.woodland import groves
from linden.scenery.scene.yard_layout import drives, yards
from linden.structured import StructuredArray


def home(facts: MapFacts) -> Scene:
    """Return the scene of Linden."""
    known, ground = surveyed(facts.geo_origin_deg), facts.ground
    free = free_lots(facts)
    houses = furnish(free, ground)
    drive = drives(free, houses)
    standing = join([houses, yards(free, houses, drive, ground), poles(free, ground)])
    standing = join([standing, shelters(known.stops_m, known.kerbs, standing, ground)])
    grown = groves(free, standing, known.railroad_m, ground)
    standing = join([standing, kept(grown, beside_buildings(grown, facts.standing))])
    standing = join([standing, kerbside_cars(free, drive, facts)])
    return join([standing, mapped(facts.standing, with_houses=False)])


def free_lots(facts: MapFacts) -> StructuredArray:
    """Return the lots clear of the railroad, marked where named places stand on them."""
    return with_taken(clear_of(facts.lots, surveyed(facts.geo_origin_deg).railroad_m), facts.standing)
