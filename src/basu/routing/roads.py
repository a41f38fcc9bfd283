"""What the client's way points do not tell about roads, from the OpenDRIVE text: posted limits, lane-section ends."""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from typing import TYPE_CHECKING

from lxml import etree

if TYPE_CHECKING:
    from collections.abc import Iterable

MPS_PER_UNIT = {"mph": 0.44704, "km/h": 1.0 / 3.6, "m/s": 1.0}  # OpenDRIVE 1.4, e_unitSpeed; without unit: m/s


@dataclass(frozen=True, slots=True)
class Road:
    """One road; places are m along its reference line, ascending, speeds m/s."""

    length_m: float
    section_starts_m: tuple[float, ...]
    limit_starts_m: tuple[float, ...]
    limits_mps: tuple[float, ...]  # nan where a stretch posts none

    def limit_at(self, s_m: float) -> float:
        """The posted limit in m/s at ``s_m``, nan where there is none."""
        index = bisect_right(self.limit_starts_m, s_m) - 1
        return self.limits_mps[index] if index >= 0 else math.nan

    def section_extent_m(self, section: int) -> tuple[float, float]:
        """Where a lane section begins and ends."""
        ends_m = (*self.section_starts_m[1:], self.length_m)
        return self.section_starts_m[section], ends_m[section]


def read_roads(opendrive: str) -> dict[int, Road]:
    """Read the roads of an OpenDRIVE text, by id."""
    root = etree.fromstring(
        opendrive.encode(), etree.XMLParser(resolve_entities=False, no_network=True, huge_tree=True)
    )
    return {int(element.get("id", "-1")): _road(element) for element in root.iterfind("road")}


def _road(element: etree._Element) -> Road:
    """One <road>."""
    posted = sorted((s, _limit_mps(e.find("speed"))) for s, e in _places(element.iterfind("type")))
    return Road(
        length_m=float(element.get("length", "0")),
        section_starts_m=tuple(sorted(s for s, _ in _places(element.iterfind("lanes/laneSection")))),
        limit_starts_m=tuple(s for s, _ in posted),
        limits_mps=tuple(limit for _, limit in posted),
    )


def _places(elements: Iterable[etree._Element]) -> list[tuple[float, etree._Element]]:
    """Elements with the place along the road that their ``s`` gives."""
    return [(float(element.get("s", "0")), element) for element in elements]


def _limit_mps(speed: etree._Element | None) -> float:
    """The value of a ``<speed>`` element in m/s; nan for none, 'no limit' and 'undefined'."""
    if speed is None:
        return math.nan
    try:
        return float(speed.get("max", "")) * MPS_PER_UNIT.get(speed.get("unit", "m/s"), math.nan)
    except ValueError:
        return math.nan
