"""The table of bodies: specifications that vehicles share, slots that grow by use, views of one world."""

import pytest

from linden.blueprints.library import packaged
from linden.physics.bodies import Bodies
from linden.physics.columns import BodyTable
from linden.protocol.values.space import Transform, Vector3D

CAR = packaged().find("vehicle.tesla.model3")


def add_car(bodies: Bodies, x_m: float = 0.0, mass_kg: float = 1845.0) -> int:
    assert CAR.vehicle is not None
    control = CAR.vehicle.physics._replace(mass=mass_kg)
    pose = Transform(Vector3D(x_m, 0.0, 0.0))
    return bodies.add_vehicle(control, pose, CAR.box, CAR.vehicle.wheel_offsets_m, CAR.vehicle.undercarriage)


def test_vehicles_of_one_design_share_a_specification_and_a_changed_one_gets_its_own() -> None:
    bodies = Bodies()
    cars = [add_car(bodies, 10.0 * n) for n in range(5)]
    assert len({int(row) for row in bodies.spec_of[cars]}) == 1
    changed = bodies.physics_control(cars[2])._replace(drag_coefficient=0.9)
    bodies.set_physics_control(cars[2], changed)
    assert bodies.spec(cars[2])["drag_kgpm"] == pytest.approx(0.9 / 0.23 * bodies.spec(cars[1])["drag_kgpm"])
    assert bodies.physics_control(cars[2]).drag_coefficient == 0.9
    assert bodies.physics_control(cars[1]).drag_coefficient == pytest.approx(0.23)


def test_a_client_that_changes_physics_for_ever_fills_no_memory() -> None:
    bodies = Bodies()
    first, second = add_car(bodies), add_car(bodies, 10.0)
    for step in range(200):
        bodies.set_physics_control(first, bodies.physics_control(first)._replace(mass=1000.0 + step))
    assert len(bodies.table.specs) <= 8
    assert bodies.physics_control(first).mass == 1199.0
    assert bodies.physics_control(second).mass == 1845.0


def test_a_body_without_wheels_has_an_empty_specification() -> None:
    bodies = Bodies()
    add_car(bodies)
    walker = bodies.add_walker(Transform(), CAR.box, 75.0)
    assert bodies.spec(walker)["wheel_count"] == 0
    bodies.remove(0)
    assert bodies.spec(0)["wheel_count"] == 0


def test_views_of_all_worlds_see_a_table_that_has_grown() -> None:
    table = BodyTable(3, slots=1)
    views = [Bodies(table, world) for world in range(3)]
    add_car(views[1], 5.0)
    for _ in range(4):
        add_car(views[2])
    assert table.state.shape[1] >= 4
    assert [view.count for view in views] == [0, 1, 4]
    views[1].position[0] = (7.0, 0.0, 0.0)
    assert table.state["position"][1, 0, 0] == 7.0
    assert [len(view.alive) for view in views] == [table.state.shape[1]] * 3
