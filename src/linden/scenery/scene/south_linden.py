"""What stands in South Linden besides its signals: houses and their yards, trees, lamps, poles, shelters, cars."""

from linden.maps.facts import MapFacts
from linden.scenery.scene.kerb_parking import kerbside_cars
from linden.scenery.scene.linden_survey import surveyed
from linden.scenery.scene.neighbourhood import furnish
from linden.scenery.scene.objects import Scene, join
from linden.scenery.scene.utility_poles import clear_of, poles, shelters
from linden.scenery.scene.woodland import groves
from linden.scenery.scene.yard_layout import drives, yards


def home(facts: MapFacts) -> Scene:
    """Return the scene of Linden."""
    known, ground = surveyed(facts.geo_origin_deg), facts.ground
    free = clear_of(facts.lots, known.railroad_m)
    houses = furnish(free, ground)
    drive = drives(free, houses)
    standing = join([houses, yards(free, houses, drive, ground), poles(free, ground)])
    standing = join([standing, shelters(known.stops_m, known.kerbs, standing, ground)])
    standing = join([standing, groves(free, standing, known.railroad_m, ground)])
    return join([standing, kerbside_cars(free, drive, facts)])
