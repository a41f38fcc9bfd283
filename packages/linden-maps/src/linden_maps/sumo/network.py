"""Converts an OpenDRIVE map to a SUMO network by netconvert, and puts back what netconvert leaves out."""

import tempfile
from pathlib import Path
from typing import NamedTuple

from lxml import etree

from linden.maps.opendrive.model import OpenDrive
from linden.maps.opendrive.parse import parse
from linden.maps.opendrive.signals import place
from linden.traffic.cycle import TIMES_S
from linden_maps.sumo import programs
from linden_maps.sumo.controls import (
    SumoSignals,
    controls_of,
    edge_patch,
    light_programs,
    node_patch,
    node_types,
)
from linden_maps.sumo.crosswalks import crossing_patch, end_at_lines, marked_legs
from linden_maps.sumo.net import Net, read_net

LANE_TYPES = """<types>
  <type id="driving" disallow="pedestrian tram rail_urban rail ship"/>
  <type id="bidirectional" disallow="pedestrian tram rail_urban rail ship"/>
  <type id="entry" disallow="pedestrian tram rail_urban rail ship"/>
  <type id="exit" disallow="pedestrian tram rail_urban rail ship"/>
  <type id="onRamp" disallow="pedestrian tram rail_urban rail ship"/>
  <type id="offRamp" disallow="pedestrian tram rail_urban rail ship"/>
  <type id="biking" allow="bicycle"/>
  <type id="sidewalk" allow="pedestrian"/>
  <type id="parking" disallow="all"/>
  <type id="shoulder" disallow="all"/>
  <type id="border" disallow="all"/>
  <type id="curb" disallow="all"/>
  <type id="stop" disallow="all"/>
  <type id="none" disallow="all"/>
  <type id="restricted" disallow="all"/>
  <type id="median" disallow="all"/>
  <type id="special1" disallow="all"/>
  <type id="special2" disallow="all"/>
  <type id="special3" disallow="all"/>
  <type id="rail" disallow="all"/>
  <type id="tram" disallow="all"/>
</types>
"""
"""What may use which lanes. CARLA's own file lets cars drive on 30 km of Linden's parking lanes."""

FIRST_PASS = (
    "--opendrive.import-all-lanes",
    "--opendrive.curve-resolution", "1",
    "--output.original-names",
    "--no-turnarounds.except-deadend",
    "--geometry.remove",
)  # fmt: skip
PEOPLE = ("--crossings.guess", "--walkingareas")


class ConvertedNetwork(NamedTuple):
    """A network with what governs its approaches."""

    net: Net
    controls: SumoSignals
    opendrive: OpenDrive


def convert(text: bytes, target: Path, *, people: bool = True) -> ConvertedNetwork:
    """Write the SUMO network of an OpenDRIVE map to ``target``; ``people`` adds crossings and walking areas.

    The same map gives the same bytes: netconvert's note on when and how it ran is left out.

    Raises:
        UserError: SUMO is not installed, or the map cannot be read or converted.
    """
    opendrive = parse(text)
    placed = place(opendrive)
    with tempfile.TemporaryDirectory(prefix="linden-sumo-") as name:
        folder = Path(name)
        (folder / "map.xodr").write_bytes(with_lane_speeds(text))
        (folder / "lanes.typ.xml").write_text(LANE_TYPES)
        first = ("--opendrive", "map.xodr", "--type-files", "lanes.typ.xml", *FIRST_PASS, "-o", "first.net.xml")
        programs.run("netconvert", first, folder)
        net = read_net(folder / "first.net.xml")
        controls = controls_of(net, placed, opendrive)
        (folder / "signs.nod.xml").write_bytes(node_patch(node_types(net, controls)))
        (folder / "signs.edg.xml").write_bytes(edge_patch(net, controls))
        legs = marked_legs(net, opendrive)
        first_pass = etree.parse(str(folder / "first.net.xml"))
        end_at_lines(first_pass.getroot(), legs)
        first_pass.write(str(folder / "lines.net.xml"))
        (folder / "marked.con.xml").write_bytes(crossing_patch(legs))
        second = (
            *("--sumo-net-file", "lines.net.xml", "--node-files", "signs.nod.xml", "--edge-files", "signs.edg.xml"),
            *("--offset.disable-normalization", "--output.original-names"),
            *(("--connection-files", "marked.con.xml", *PEOPLE) if people else ()),
            *("-o", "second.net.xml"),
        )
        programs.run("netconvert", second, folder)
        _finish(folder / "second.net.xml", controls, opendrive, target)
    return ConvertedNetwork(read_net(target), controls, opendrive)


def with_lane_speeds(text: bytes) -> bytes:
    """Give each driving lane without a speed that of its road, which netconvert does not read."""
    root = etree.fromstring(text)
    for road in root.iter("road"):
        kinds = [kind for kind in road.findall("type") if kind.find("speed") is not None]
        for section in road.iter("laneSection"):
            start_m = float(section.get("s", 0.0))
            holding = [kind for kind in kinds if float(kind.get("s", 0.0)) <= start_m + 1e-6] or kinds[:1]
            if not holding:
                continue
            speed = holding[-1].find("speed")
            assert speed is not None, "the kinds have one"
            for lane in section.iter("lane"):
                if lane.get("type") == "driving" and lane.find("speed") is None:
                    given = {"sOffset": "0", "max": str(speed.get("max")), "unit": str(speed.get("unit", "m/s"))}
                    etree.SubElement(lane, "speed", given)
    return etree.tostring(root)


def _finish(source: Path, controls: SumoSignals, opendrive: OpenDrive, target: Path) -> None:
    """Replace the lights' programs by the server's, and write the network without the note of netconvert."""
    root = etree.parse(str(source), etree.XMLParser(remove_comments=True)).getroot()
    net = read_net(source)
    ranked = sorted(enumerate(opendrive.controllers), key=lambda each: (each[1].sequence, each[0]))
    order = {controller.id: rank for rank, (_, controller) in enumerate(ranked)}
    made = light_programs(net, controls, order, TIMES_S)
    for old in list(root.iter("tlLogic")):
        new = made.get(str(old.get("id")))
        parent = old.getparent()
        if new is not None and len(new) and parent is not None:
            new.tail = old.tail
            parent.replace(old, new)
    etree.indent(root)
    target.write_bytes(etree.tostring(root, xml_declaration=True, encoding="UTF-8") + b"\n")
