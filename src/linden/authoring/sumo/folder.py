"""The scenario folder: network, vehicle types, stops, demand, and the configurations that SUMO's programs open."""

from pathlib import Path
from typing import NamedTuple

from lxml import etree

from linden.authoring.sumo.bus_stops import RouteStop, stops_file
from linden.authoring.sumo.demand import Demand, check, draw, trips_file
from linden.authoring.sumo.network import Converted, convert
from linden.authoring.sumo.vehicle_types import types_file
from linden.errors import UserError

STEP_S = 0.05  # as a benchmark's tick


class Written(NamedTuple):
    """What was written."""

    converted: Converted
    config: Path  # with the demand
    empty: Path  # without it
    trips: int
    lost_stops: tuple[RouteStop, ...]


def write_folder(
    text: bytes, name: str, folder: Path, demand: Demand, stops: tuple[RouteStop, ...] = (), *, people: bool = True
) -> Written:
    """Write the scenario folder of an OpenDRIVE map; the same input gives the same bytes.

    Raises:
        UserError: SUMO is not installed, the map cannot be converted, or the folder cannot be written.
    """
    check(demand)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        converted = convert(text, folder / f"{name}.net.xml", people=people)
        trips = draw(converted.net, demand)
        (folder / f"{name}.rou.xml").write_bytes(trips_file(trips))
        (folder / "types.add.xml").write_bytes(types_file())
        content, lost = stops_file(converted.net, stops)
        (folder / "stops.add.xml").write_bytes(content)
        config, empty = folder / f"{name}.sumocfg", folder / f"{name}.empty.sumocfg"
        config.write_bytes(_config(name, demand, has_trips=True))
        empty.write_bytes(_config(name, demand, has_trips=False))
    except OSError as error:
        raise UserError(f"cannot write to {folder}: {error.strerror}; name a folder that you may write to") from None
    return Written(converted, config, empty, len(trips), lost)


def _config(name: str, demand: Demand, *, has_trips: bool) -> bytes:
    """A configuration of SUMO. The types stand before the routes, which need them."""
    root = etree.Element("configuration")
    given = etree.SubElement(root, "input")
    etree.SubElement(given, "net-file", {"value": f"{name}.net.xml"})
    etree.SubElement(given, "additional-files", {"value": "types.add.xml,stops.add.xml"})
    if has_trips:
        etree.SubElement(given, "route-files", {"value": f"{name}.rou.xml"})
    time = etree.SubElement(root, "time")
    etree.SubElement(time, "begin", {"value": "0"})
    etree.SubElement(time, "step-length", {"value": f"{STEP_S:g}"})
    numbers = etree.SubElement(root, "random_number")
    etree.SubElement(numbers, "seed", {"value": str(demand.seed)})
    processing = etree.SubElement(root, "processing")
    etree.SubElement(processing, "time-to-teleport", {"value": "-1"})
    etree.SubElement(processing, "collision.action", {"value": "warn"})
    return etree.tostring(root, pretty_print=True, xml_declaration=True, encoding="UTF-8")
