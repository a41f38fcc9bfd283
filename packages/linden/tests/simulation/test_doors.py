"""Claims about the doors of vehicles."""

import pytest

from linden.blueprints.library import BlueprintKind
from linden.errors import Refusal
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.enums import AttributeType
from linden.protocol.values.space import BoundingBox
from linden.simulation.actor_table import ActorRecord
from linden.simulation.doors import SIDE_DOORS, Door, Doors


def vehicle(actor_id: int, *, has_doors: bool = True) -> ActorRecord:
    said = AttributeValue("has_dynamic_doors", AttributeType.BOOL, "true" if has_doors else "false")
    return ActorRecord(
        actor_id, ActorDescription(0, "vehicle.some.car", (said,)), BlueprintKind.VEHICLE, BoundingBox(), b""
    )


def test_a_door_is_open_until_it_is_closed() -> None:
    doors, car = Doors(), vehicle(7)
    doors.swing(car, Door.FRONT_LEFT, opens=True)
    doors.swing(car, Door.REAR_RIGHT, opens=True)
    assert doors.open == {7: {Door.FRONT_LEFT, Door.REAR_RIGHT}}
    doors.swing(car, Door.FRONT_LEFT, opens=False)
    doors.swing(car, Door.FRONT_LEFT, opens=False)
    assert doors.open == {7: {Door.REAR_RIGHT}}


def test_all_means_every_door_there_is() -> None:
    doors, car = Doors(), vehicle(7)
    doors.swing(car, Door.ALL, opens=True)
    assert doors.open[7] == set(SIDE_DOORS)
    doors.swing(car, Door.ALL, opens=False)
    assert not doors.open


def test_a_destroyed_vehicle_has_no_open_doors() -> None:
    doors = Doors()
    doors.swing(vehicle(7), Door.ALL, opens=True)
    doors.swing(vehicle(8), Door.ALL, opens=True)
    doors.forget(7)
    doors.forget(9)
    assert list(doors.open) == [8]


@pytest.mark.parametrize("door", [Door.HOOD, Door.TRUNK, 7, 255])
def test_a_door_that_is_not_there_is_refused(door: int) -> None:
    with pytest.raises(Refusal, match=rf"actor 7\) has no door {int(door)}"):
        Doors().swing(vehicle(7), door, opens=True)


def test_a_vehicle_without_doors_says_so() -> None:
    with pytest.raises(Refusal, match="has_dynamic_doors is false"):
        Doors().swing(vehicle(7, has_doors=False), Door.ALL, opens=False)
