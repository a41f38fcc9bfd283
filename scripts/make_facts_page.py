"""Write docs/reference/linden-facts.md, the share of Linden's facts by origin: `make_facts_page.py [--check]`."""

from __future__ import annotations

import json
import sys
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

from generated_page import write_or_check

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "docs" / "reference" / "linden-facts.md"
FACTS = ROOT / "packages" / "linden" / "src" / "linden" / "data" / "linden.geojson"
MEASURED, READ, ESTIMATED, UNSAID = "measured", "read", "estimated", "no origin"
ORIGINS = (MEASURED, READ, ESTIMATED, UNSAID)
HEAD = """# Where Linden's facts come from

<!-- written by scripts/make_facts_page.py -->

`packages/linden/src/linden/data/linden.geojson` has the facts of which the shipped map is built. Most values have a
neighbour that says how sure they are, such as `lanes_confidence` for `lanes`. This page counts them.

| word | meaning |
|---|---|
| measured | coordinates of a public data set: census blocks, crash records, bus stops, bike stations, addresses |
| read | a value that a document or a record states |
| estimated | chosen here: by a rule, by what is usual, or by a guess |
| no origin | the file states a value and not where it comes from; read it as estimated |

"""
TAIL = """
Values that contradict each other or bear a wrong label in their source count as read or measured here. Their
`confidence` says so.

What the file does not have is drawn by rules with a fixed seed. These are houses, porches, trees, fences, lamps,
poles, crosswalks, lane markings and the railroad's track. No picture of the real place was compared
([maps](maps.md#linden)).

## How steep

The ground is a plane: {north:.2f} % up to the north and {east:.2f} % up to the east, {base_m:g} m high at the origin.
All three are estimated. No measured elevation model is in the map. So hills, dips and the real slope of single streets
are missing. `linden map build --elevation FILE` lays the streets on one, a GeoTIFF, LAS or LAZ.

## Sources

{sources}
"""


class Fact(NamedTuple):
    """A value that features of a kind have."""

    title: str
    feature: str
    value: str  # the property; "" for the place
    confidence: str | None  # the property that says how sure it is
    origin: str  # what it is where a source has it


FACTS_OF_MAP = (
    Fact("centre lines of streets", "street", "", "confidence", MEASURED),
    Fact("names of streets", "street", "name", "name_confidence", READ),
    Fact("speed limits", "street", "speed_limit_mph", "speed_confidence", READ),
    Fact("numbers of lanes", "street", "lanes", "lanes_confidence", READ),
    Fact("widths", "street", "width_m", "width_confidence", MEASURED),
    Fact("parking", "street", "parking", "parking_confidence", READ),
    Fact("sidewalks", "street", "sidewalk", "sidewalk_confidence", READ),
    Fact("one-way streets", "street", "oneway", None, READ),
    Fact("surfaces", "street", "surface", None, READ),
    Fact("places of intersections", "intersection", "", "confidence", MEASURED),
    Fact("control of intersections", "intersection", "control", "control_confidence", READ),
    Fact("stops of the shuttle", "shuttle_stop", "", "confidence", MEASURED),
    Fact("points of interest", "poi", "", "confidence", MEASURED),
    Fact("places of named buildings", "building", "", "confidence", MEASURED),
    Fact("outlines of named buildings", "building", "", "size_confidence", MEASURED),
    Fact("heights of named buildings", "building", "height_m", "height_confidence", MEASURED),
    Fact("signs with the names of buildings", "building", "name_sign_confidence", "name_sign_confidence", MEASURED),
    Fact("benches, bins, mailboxes", "furniture", "", "confidence", MEASURED),
    Fact("the railroad", "railroad", "", "confidence", MEASURED),
    Fact("crossings of the railroad", "railroad_crossing", "", "confidence", MEASURED),
    Fact("courses of routes", "route", "", "confidence", READ),
)


def origin_of(fact: Fact, properties: dict[str, Any]) -> str:
    """Return where a feature's value comes from, by the first word of its confidence."""
    said = None if fact.confidence is None else properties.get(fact.confidence)
    if not said:
        return UNSAID
    if said.startswith(("verified", "one source")):
        return fact.origin
    if said.startswith(("estimated", "unverified", "inferred")):
        return ESTIMATED
    raise ValueError(f"{properties.get('id')}: '{said}' is no word of the scale of confidence")


def counts(document: dict[str, Any], fact: Fact) -> Counter[str]:
    """Return the number of features that have the value, by its origin."""
    found = [each["properties"] for each in document["features"] if each["properties"]["feature"] == fact.feature]
    return Counter(origin_of(fact, each) for each in found if not fact.value or fact.value in each)


def page(document: dict[str, Any]) -> str:
    """Return the page of the facts' origins as Markdown."""
    lines = ["| fact | number | measured | read | estimated | no origin |", "|---|---|---|---|---|---|"]
    everything: Counter[str] = Counter()
    for fact in FACTS_OF_MAP:
        found = counts(document, fact)
        everything += found
        lines.append(_row(fact.title, found))
    lines.append(_row("**all**", everything))
    streets = [each["properties"] for each in document["features"] if each["properties"]["feature"] == "street"]
    metres: Counter[str] = Counter()
    for each in streets:
        metres[origin_of(FACTS_OF_MAP[0], each)] += round(each["length_m"])
    km = sum(metres.values()) / 1000.0
    said = f"\nBy length, {metres[MEASURED] / 10.0 / km:.0f} % of the {km:.1f} km of centre lines are measured.\n"
    metadata = document["metadata"]
    sources = "\n".join(
        f"- {each.strip()}" for each in metadata["authored_from"].removeprefix("coordinate facts in: ").split(";")
    )
    ground = metadata["ground"]
    tail = TAIL.format(
        sources=sources,
        base_m=ground["base_m"],
        north=100.0 * ground["rise_north"],
        east=100.0 * ground["rise_east"],
    )
    return HEAD + "\n".join(lines) + "\n" + said + tail


def _row(title: str, found: Counter[str]) -> str:
    """Return a line of the table."""
    number = sum(found.values())
    shares = (f"{100.0 * found[each] / number:.0f} %" if found[each] else "" for each in ORIGINS)
    return f"| {title} | {number} | {' | '.join(shares)} |"


if __name__ == "__main__":
    sys.exit(write_or_check(__file__, __doc__, lambda: {PAGE: page(json.loads(FACTS.read_text(encoding="utf-8")))}))
