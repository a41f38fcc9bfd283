"""What is derived from a map is computed once, and goes with the map."""

import gc
import weakref

from linden.maps.opendrive.evaluate.tables import tables_of
from linden.maps.opendrive.links import lane_links
from linden.maps.opendrive.model import OpenDrive, kept
from linden.maps.opendrive.parse import parse
from opendrive_texts import street_through_junction


def test_it_is_computed_once_for_each_map() -> None:
    seen = []

    @kept
    def name_of(opendrive: OpenDrive) -> str:
        seen.append(opendrive)
        return opendrive.name

    first, second = (parse(street_through_junction() + "\n" * lines) for lines in (1, 2))  # one text is one map
    assert [name_of(first), name_of(second), name_of(first), name_of(second)] == ["Test"] * 4
    assert seen == [first, second]


def test_an_unreferenced_map_is_freed_at_once_with_all_that_was_derived_from_it() -> None:
    opendrive = parse(street_through_junction() + "\n" * 3)  # a text that no other test holds
    gone = [weakref.ref(thing) for thing in (opendrive, tables_of(opendrive))]
    lane_links(opendrive)
    gc.disable()  # so that nothing waits for the collector
    try:
        del opendrive
        assert [reference() for reference in gone] == [None, None]
    finally:
        gc.enable()
