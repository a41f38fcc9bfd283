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

SHADES = {"passenger": "yellow", "delivery": "orange", "truck": "orange", "bus": "red", "motorcycle": "cyan",
          "bicycle": "green"}  # fmt: skip


def blueprints() -> dict[str, Any]:
    """The facts of all vehicles by their name without "vehicle."."""
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
    names = [name for kind in SHARES for name in common[kind]]
    weights = [SHARES[kind] / len(common[kind]) for kind in SHARES for _ in common[kind]]
    etree.SubElement(
        root,
        "vTypeDistribution",
        {"id": MIX, "vTypes": " ".join(names), "probabilities": " ".join(f"{weight:.5f}" for weight in weights)},
    )
    return etree.tostring(root, pretty_print=True, xml_declaration=True, encoding="UTF-8")
