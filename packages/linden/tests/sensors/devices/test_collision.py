"""Collisions: who is told of which contact, and what scenery is called."""

import numpy as np
import pytest
from numpy.typing import NDArray

from linden.physics.contact.statics import scenery_type
from linden.protocol.values.enums import SemanticTag
from linden.sensors.devices.collision import SCENERY, collisions

CONTACT = np.dtype(
    [("a", "i4"), ("b", "i4"), ("static_id", "i8"), ("tag", "u1"), ("impulse", "f8", 3), ("point", "f8", 3)]
)


def contacts(*rows: tuple[int, int, float]) -> NDArray[np.void]:
    """Return contacts of a with b whose impulse on a is (x, 0, 0), at a place that counts up."""
    made = np.zeros(len(rows), CONTACT)
    for number, (a, b, impulse) in enumerate(rows):
        made[number] = (a, b, 5, SemanticTag.BUILDINGS if b == SCENERY else 0, (impulse, 0, 0), (number, 0, 0))
    return made


def test_both_sides_get_opposite_impulses() -> None:
    one, other = collisions(contacts((3, 8, 120.0)), {3: [50], 8: [60]})
    assert (one.sensor_id, one.slot, one.other_slot, one.impulse_ns) == (50, 3, 8, (120.0, 0.0, 0.0))
    assert (other.sensor_id, other.slot, other.other_slot, other.impulse_ns) == (60, 8, 3, (-120.0, 0.0, 0.0))


def test_scenery_is_named_and_carries_no_sensor() -> None:
    (event,) = collisions(contacts((3, SCENERY, 9.0)), {3: [50]})
    assert (event.other_slot, event.scenery_type) == (SCENERY, "static.building")


def test_a_body_without_sensor_reports_nothing() -> None:
    assert list(collisions(contacts((3, 8, 1.0)), {4: [50]})) == []


def test_every_sensor_of_a_carrier_gets_the_event() -> None:
    assert [event.sensor_id for event in collisions(contacts((3, 8, 1.0)), {3: [50, 51]})] == [50, 51]


def test_a_pair_is_reported_once_a_frame_with_its_whole_impulse() -> None:
    found = list(collisions(contacts((3, 8, 1.0), (3, 9, 5.0), (3, 8, 2.0)), {3: [50]}))
    assert [(event.other_slot, event.impulse_ns.x, event.point_m.x) for event in found] == [
        (8, 3.0, 0.0),
        (9, 5.0, 1.0),
    ]


def test_contacts_are_left_as_they_were() -> None:
    rows = contacts((3, 8, 1.0), (3, 8, 2.0))
    kept = rows.copy()
    list(collisions(rows, {3: [50]}))
    assert rows.tobytes() == kept.tobytes()


@pytest.mark.parametrize(
    ("tag", "name"),
    [
        (SemanticTag.ROADS, "static.road"),
        (SemanticTag.FENCES, "static.fence"),
        (SemanticTag.TRAFFIC_LIGHT, "static.trafficlight"),
        (SemanticTag.GUARD_RAIL, "static.guardrail"),
        (SemanticTag.VEGETATION, "static.vegetation"),
        (SemanticTag.OTHER, "static.unknown"),
        (SemanticTag.NONE, "static.unknown"),
    ],
)
def test_scenery_is_called_as_carla_calls_it(tag: SemanticTag, name: str) -> None:
    assert scenery_type(tag) == name
