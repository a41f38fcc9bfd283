"""The scenario folder: network, vehicle types, stops, demand, and the configurations that SUMO's programs open."""

from pathlib import Path
from typing import NamedTuple

from lxml import etree

from linden.maps.facts import derive
from linden.maps.library import HOME_MAPS
from linden.maps.navigation.areas import crosswalk_outlines
from linden.scenery.scene.objects import ObjectKind
from linden.scenery.scene.south_linden import home
from linden_maps.output import staged_folder
from linden_maps.sumo.bus_stops import STOP_CLEAR_M, BusStop, RouteStop, bus_stops, parking_areas, stops_file
from linden_maps.sumo.demand import Demand, check, draw, trips_file
from linden_maps.sumo.network import ConvertedNetwork, convert
from linden_maps.sumo.people import draw_riders, draw_walks, people_file
from linden_maps.sumo.places import places_of
from linden_maps.sumo.vehicle_types import types_file

CROSSWALK_CLEAR_M = 6.1  # 20 feet, as Columbus City Code 2151.01 asks for
CAR_CLEAR_M = 2.8  # half a parked car, and room before it
STEP_S = 0.05  # as a benchmark's tick
OURS = (".net.xml", ".rou.xml", ".add.xml", ".sumocfg")  # ends of the names of files in such a folder


class Written(NamedTuple):
    """What was written."""

    converted: ConvertedNetwork
    config: Path  # with the demand
    empty: Path  # without it
    trips: int
    walks: int
    riders: int
    lost_stops: tuple[RouteStop, ...]


def write_folder(
    text: bytes,
    name: str,
    folder: Path,
    demand: Demand,
    stops: tuple[RouteStop, ...] = (),
    *,
    people: bool = True,
    has_riders: bool = True,
    places: Path | None = None,
) -> Written:
    """Write the scenario folder of an OpenDRIVE map; the same input gives the same bytes.

    ``places`` is a GeoJSON file with places that people go to; without it those of Linden, where the map has them.

    Raises:
        UserError: SUMO is not installed, the map cannot be converted, or the folder cannot be written. Then an older
            folder is left as it was.
    """
    check(demand)
    with staged_folder(folder, lambda entry: entry.endswith(OURS)) as stage:
        converted = convert(text, stage / f"{name}.net.xml", people=people)
        net, found = converted.net, places_of(places, converted.opendrive.geo_origin)
        at_stops, lost = bus_stops(net, stops)
        at_kerbs = parking_areas(net, _taken(converted, text, name, at_stops))
        trips = draw(net, demand, found, at_kerbs)
        walks = draw_walks(net, demand, found) if people else []
        riders = draw_riders(net, demand, at_stops) if people and has_riders else []
        (stage / f"{name}.rou.xml").write_bytes(trips_file(trips))
        (stage / f"{name}.people.rou.xml").write_bytes(people_file(walks, riders, at_stops))
        (stage / "types.add.xml").write_bytes(types_file())
        (stage / "stops.add.xml").write_bytes(stops_file(at_stops, at_kerbs))
        (stage / f"{name}.sumocfg").write_bytes(_config(name, demand, has_trips=True))
        (stage / f"{name}.empty.sumocfg").write_bytes(_config(name, demand, has_trips=False))
    configs = folder / f"{name}.sumocfg", folder / f"{name}.empty.sumocfg"
    return Written(converted, *configs, len(trips), len(walks), len(riders), lost)


def _taken(
    converted: ConvertedNetwork, text: bytes, name: str, stops: tuple[BusStop, ...]
) -> list[tuple[float, float, float]]:
    """Return where nothing may park, x, y and radius in SUMO's frame: crosswalks, bus stops, and the map's parked cars.

    Only the maps of Linden have parked cars in their scenery.
    """
    x_m, y_m = converted.net.offset_m
    taken = [(*stop.at_m, STOP_CLEAR_M) for stop in stops]
    for _, outline_m in crosswalk_outlines(converted.opendrive):
        taken += [(x + x_m, y + y_m, CROSSWALK_CLEAR_M) for x, y in outline_m]
    if name in HOME_MAPS:
        things = home(derive(text.decode())).things
        for at_m in things["base"][things["kind"] == ObjectKind.PARKED_CAR]:
            taken.append((float(at_m[0]) + x_m, y_m - float(at_m[1]), CAR_CLEAR_M))
    return taken


def _config(name: str, demand: Demand, *, has_trips: bool) -> bytes:
    """Return a configuration of SUMO. The types stand before the routes, which need them."""
    root = etree.Element("configuration")
    given = etree.SubElement(root, "input")
    etree.SubElement(given, "net-file", {"value": f"{name}.net.xml"})
    etree.SubElement(given, "additional-files", {"value": "types.add.xml,stops.add.xml"})
    if has_trips:
        etree.SubElement(given, "route-files", {"value": f"{name}.rou.xml,{name}.people.rou.xml"})
    time = etree.SubElement(root, "time")
    etree.SubElement(time, "begin", {"value": "0"})
    etree.SubElement(time, "step-length", {"value": f"{STEP_S:g}"})
    numbers = etree.SubElement(root, "random_number")
    etree.SubElement(numbers, "seed", {"value": str(demand.seed)})
    processing = etree.SubElement(root, "processing")
    etree.SubElement(processing, "time-to-teleport", {"value": "-1"})
    etree.SubElement(processing, "collision.action", {"value": "warn"})
    etree.SubElement(processing, "collision.check-junctions", {"value": "true"})
    return etree.tostring(root, pretty_print=True, xml_declaration=True, encoding="UTF-8")
