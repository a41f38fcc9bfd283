"""`category_of` and tables: the class of an actor or a map object; objects without a class are not in the truth."""

from __future__ import annotations

from typing import TYPE_CHECKING

import carla

from basu.records.partners import BICYCLES, Partner, partner_of

if TYPE_CHECKING:
    from collections.abc import Mapping

OF_BASE_TYPE = {
    "car": "car",
    "van": "car",
    "truck": "truck",
    "bus": "bus",
    "motorcycle": "motorcycle",
    "bicycle": "bicycle",
}
"""CARLA's attribute ``base_type`` of a vehicle -> class."""

OF_PROP = {
    "static.prop.trafficcone": "traffic_cone",
    "static.prop.constructioncone": "traffic_cone",
    "static.prop.streetbarrier": "barrier",
    "static.prop.chainbarrier": "barrier",
}
"""The beginning of a prop's blueprint -> class; other props have none."""

OF_LABEL = {
    carla.CityObjectLabel.Car: "car",
    carla.CityObjectLabel.Truck: "truck",
    carla.CityObjectLabel.Bus: "bus",
    carla.CityObjectLabel.Motorcycle: "motorcycle",
    carla.CityObjectLabel.Bicycle: "bicycle",
}
"""The label of a thing of the map -> class."""

LABELS = tuple(int(label) for label in OF_LABEL)
"""The semantic tags of these things in pictures and clouds."""


def category_of(type_id: str, attributes: Mapping[str, str]) -> str | None:
    """Return the class of an actor by its blueprint and its attributes; None where it is no object of the truth."""
    partner = partner_of(type_id)
    if partner is Partner.ANIMAL:
        return "animal"
    if partner is Partner.WALKER:
        return "pedestrian"
    if type_id.startswith("vehicle."):
        usual = "bicycle" if type_id in BICYCLES else "car"
        return OF_BASE_TYPE.get(attributes.get("base_type", ""), usual)
    return next((name for prefix, name in OF_PROP.items() if type_id.startswith(prefix)), None)
