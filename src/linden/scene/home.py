"""What stands in South Linden besides its signals: houses and their yards, trees, lamps, poles, shelters, cars."""

from linden.scene.groves import groves
from linden.scene.kerbside import kerbside_cars
from linden.scene.neighbourhood import furnish
from linden.scene.objects import Scene, join
from linden.scene.streetside import clear_of, poles, shelters
from linden.scene.surveyed import surveyed
from linden.scene.yards import drives, yards
from linden.world.map_facts import MapFacts


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
