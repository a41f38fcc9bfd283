"""SUMO's vehicle types: one for each blueprint, of its true size, and how often each is met."""

import json
from importlib import resources
from typing import Any

from lxml import etree

CLASSES = {
    "car": "passenger",
    "van": "delivery",
    "truck": "truck",
    "bus": "bus",
    "motorcycle": "motorcycle",
    "bicycle": "bicycle",
}
"""SUMO's vehicle class by CARLA's base type."""

SHARES = {"car": 0.88, "van": 0.05, "truck": 0.02, "bus": 0.01, "motorcycle": 0.01, "bicycle": 0.03}
"""Share of each base type in the traffic: estimates for a residential neighbourhood, no count was to be had."""

RARE = frozenset({"carlamotors.firetruck", "ford.ambulance", "easymile.ez10", "carlamotors.carlacola",
                  "dodge.charger_police", "dodge.charger_police_2020"})  # fmt: skip
"""Blueprints that have a type and that no demand draws: emergency vehicles, the shuttle, a fancy truck."""

MIX = "traffic"
"""The name of the distribution that all of a demand's vehicles are drawn from."""

KERB_MIX = "kerb"
"""The name of the distribution of trips that begin or end in a parking space: the vehicles that fit in one."""
KERB_LENGTH_M = 6.2  # of a space of 6.7 m at the kerb

SHADES = {"passenger": "yellow", "delivery": "orange", "truck": "orange", "bus": "red", "motorcycle": "cyan",
          "bicycle": "green"}  # fmt: skip


def blueprints() -> dict[str, Any]:
    """Return the facts of all vehicles by their name without "vehicle."."""
    data = (resources.files("linden") / "data" / "blueprints.json").read_text(encoding="utf-8")
    vehicles: dict[str, Any] = json.loads(data)["vehicles"]
    return vehicles


def types_file() -> bytes:
    """SUMO's additional file with a type for each blueprint and their distribution."""
    root = etree.Element("additional")
    facts = blueprints()
    common: dict[str, list[str]] = {kind: [] for kind in SHARES}
    for name, fact in facts.items():
        kind = CLASSES[fact["base_type"]]
        half_x_m, half_y_m, half_z_m = fact["half_m"]
        attributes = {
            "id": f"vehicle.{name}",
            "vClass": kind,
            "length": f"{2 * half_x_m:.3f}",
            "width": f"{2 * half_y_m:.3f}",
            "height": f"{2 * half_z_m:.3f}",
            "color": SHADES[kind],
        }
        etree.SubElement(root, "vType", attributes)
        if name not in RARE and fact["base_type"] in common:
            common[fact["base_type"]].append(f"vehicle.{name}")
    etree.SubElement(root, "vTypeDistribution", _mix(MIX, common))
    short = {
        kind: [name for name in names if _length_m(facts, name) <= KERB_LENGTH_M] for kind, names in common.items()
    }
    etree.SubElement(root, "vTypeDistribution", _mix(KERB_MIX, {kind: short[kind] for kind in ("car", "van")}))
    return etree.tostring(root, pretty_print=True, xml_declaration=True, encoding="UTF-8")


def _mix(name: str, types: dict[str, list[str]]) -> dict[str, str]:
    """Return the attributes of a distribution of ``types`` by their base type."""
    names = [each for kind in types for each in types[kind]]
    weights = [SHARES[kind] / len(types[kind]) for kind in types for _ in types[kind]]
    return {
        "id": name,
        "vTypes": " ".join(names),
        "probabilities": " ".join(f"{weight:.5f}" for weight in weights),
    }


def _length_m(facts: dict[str, Any], name: str) -> float:
    return 2.0 * float(facts[name.removeprefix("vehicle.")]["half_m"][0])
