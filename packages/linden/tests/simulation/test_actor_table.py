"""The table of actors: rows stay in the order of coming, ids are never used twice, the end of an actor is told once."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from linden.blueprints.library import BlueprintKind
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.enums import ActorState
from linden.protocol.values.space import BoundingBox, Transform, Vector3D
from linden.simulation.actor_table import NO_BODY, ActorRecord, ActorRefusal, ActorTable


def add(table: ActorTable, *, parent_id: int = 0, slot: int = NO_BODY, x: float = 0.0) -> ActorRecord:
    record = ActorRecord(
        table.next_id(),
        ActorDescription(0, "test"),
        BlueprintKind.OTHER,
        BoundingBox(),
        b"",
        parent_id=parent_id,
        slot=slot,
    )
    pose = Transform(Vector3D(x, 0.0, 0.0))
    table.add(record, pose, pose if parent_id else None)
    return record


def shown(table: ActorTable) -> list[int]:
    return table.rows["id"][: len(table)].tolist()


def test_an_unknown_id_is_refused_in_carlas_words() -> None:
    with pytest.raises(ActorRefusal, match=r"Actor could not be found in the registry\.  Actor Id: 7"):
        ActorTable().get(7)


def test_a_destroyed_actor_is_not_in_the_next_frame() -> None:
    table = ActorTable()
    first, second = add(table), add(table)
    table.remove(first.id, announce=False)
    table.turn_page()
    assert shown(table) == [second.id]
    assert first.id not in table


def test_an_announced_end_is_in_one_snapshot() -> None:
    table = ActorTable()
    first, second = add(table), add(table)
    table.remove(first.id, announce=True)
    table.turn_page()
    assert shown(table) == [first.id, second.id]
    assert table.rows["actor_state"][:2].tolist() == [ActorState.PENDING_KILL, ActorState.ACTIVE]
    table.turn_page()
    assert shown(table) == [second.id]


def test_rows_of_destroyed_actors_are_used_again_where_no_frame_is_made() -> None:
    table = ActorTable()
    stays = add(table)
    for _ in range(1000):
        table.remove(add(table).id, announce=False)
    assert len(table.rows) == 256
    assert table.row(stays.id) == 0


def test_an_id_that_became_free_in_this_very_frame_can_be_given_again() -> None:
    table = ActorTable()
    first, second = add(table), add(table)
    table.remove(first.id, announce=False)
    with table.preferring(first.id):
        again = add(table, x=3.0)
    assert again.id == first.id
    for _ in range(3):
        assert shown(table) == [second.id, again.id]
        assert table.transform(again.id).location.x == 3.0
        table.turn_page()


def test_a_parent_forgets_the_children_that_have_left() -> None:
    table = ActorTable()
    parent = add(table)
    elder, younger = add(table, parent_id=parent.id), add(table, parent_id=parent.id)
    table.remove(elder.id, announce=False)
    assert table.children(parent.id) == [younger]
    table.remove(younger.id, announce=True)
    assert table.children(parent.id) == []


def test_children_keep_their_parent_when_rows_move_up() -> None:
    table = ActorTable()
    gone, parent = add(table), add(table, x=1.0)
    child = add(table, parent_id=parent.id, x=2.0)
    table.remove(gone.id, announce=False)
    table.turn_page()
    assert table.parent_row[table.row(child.id)] == table.row(parent.id)
    assert [record.id for record in table.children(parent.id)] == [child.id]
    assert table.relative_transform(child.id).location.x == 2.0


def test_placing_a_child_moves_it_in_its_parents_frame() -> None:
    table = ActorTable()
    parent = add(table, x=5.0)
    child = add(table, parent_id=parent.id)
    table.place(child.id, Transform(Vector3D(0.0, 3.0, 0.0)))
    assert table.relative_transform(child.id).location.y == 3.0
    table.place(parent.id, Transform(Vector3D(6.0, 0.0, 0.0)))
    assert table.transform(parent.id).location.x == 6.0


@given(st.lists(st.integers(0, 30)))
def test_any_coming_and_going_keeps_order_and_columns_together(moves: list[int]) -> None:
    table = ActorTable()
    expected: list[int] = []
    for move in moves:
        if move < 20 or not expected:
            expected.append(add(table, x=float(table._next_id)).id)
        else:
            table.remove(expected.pop(move % len(expected)), announce=False)
    assert expected == [record.id for record in table]
    table.turn_page()
    assert shown(table) == expected
    assert table.pose[: len(table), 0].tolist() == list(map(float, expected))


def test_the_table_grows() -> None:
    table = ActorTable()
    ids = [add(table, x=float(n)).id for n in range(600)]
    assert shown(table) == ids
    assert table.pose[:600, 0].tolist() == list(map(float, range(600)))


def test_lamps_are_those_of_the_vehicles_that_are_there() -> None:
    table = ActorTable()
    add(table)
    first, second = add(table), add(table)
    assert table.lamps() == []
    for record in (first, second):
        table.remove(record.id, announce=False)
    cars = []
    for _ in range(3):
        record = ActorRecord(table.next_id(), ActorDescription(0, "car"), BlueprintKind.VEHICLE, BoundingBox(), b"")
        table.add(record, Transform())
        cars.append(record.id)
        assert table.lamps() == [(car, 0) for car in cars]
    table.set_lamps(cars[1], 5)
    assert table.lamps() == [(cars[0], 0), (cars[1], 5), (cars[2], 0)]
    table.remove(cars[0], announce=False)
    assert table.lamps() == [(cars[1], 5), (cars[2], 0)]


def test_the_next_episode_counts_on_from_the_last_one() -> None:
    before = ActorTable()
    used = [add(before).id for _ in range(3)]
    after = ActorTable(before.first_free_id)
    assert add(after).id == max(used) + 1
