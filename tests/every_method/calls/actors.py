"""Actors of any kind, their lists, snapshots and blueprints."""

from typing import Any

import carla
import pytest

from every_method.call import Call
from every_method.entries import fields
from every_method.stage import Stage

BONE = "crl_hips__C"


def thrown(stage: Stage) -> carla.Actor:
    """Something to push."""
    return stage.once("prop", lambda: stage.spawn("static.prop.box01", 6))


def passing(stage: Stage) -> carla.Vehicle:
    """A car to order about, far from the one that others look at."""
    return stage.once("passing", lambda: stage.spawn("vehicle.tesla.model3", 8))


def moved_to(stage: Stage, way: str) -> bool:
    """Whether an actor stands, a frame later, where it was put."""
    spectator = stage.world.get_spectator()
    if way == "location":
        spectator.set_location(carla.Location(1.0, 2.0, 30.0))
    else:
        spectator.set_transform(carla.Transform(carla.Location(1.0, 2.0, 31.0)))
    stage.tick(1)
    return spectator.get_location().z == pytest.approx(30.0 if way == "location" else 31.0)


def after(stage: Stage, call: Any, holds: Any) -> bool:
    """Make a call, let two frames pass, and see whether what it should do has happened."""
    call()
    stage.tick(2)
    return bool(holds())


def destroyed(stage: Stage) -> bool:
    """Whether an actor goes."""
    gone = stage.spawn("static.prop.mailbox", 10)
    return gone.destroy()


def mount(stage: Stage) -> carla.Actor:
    """Something that is attached."""
    return stage.once("mount", lambda: stage.sensor("sensor.other.gnss"))


def blueprint(stage: Stage) -> carla.ActorBlueprint:
    """A car's."""
    return stage.once("library", stage.world.get_blueprint_library).find("vehicle.lincoln.mkz_2020")


def attribute(stage: Stage, name: str = "color") -> carla.ActorAttribute:
    """One of a car's."""
    return blueprint(stage).get_attribute(name)


def number(stage: Stage) -> carla.ActorAttribute:
    """An attribute that is a number."""
    return attribute(stage, "number_of_wheels")


def painted(stage: Stage) -> bool:
    """Whether an attribute is set."""
    found = blueprint(stage)
    found.set_attribute("color", "1,2,3")
    return found.get_attribute("color").as_color() == carla.Color(1, 2, 3)


def snapshot(stage: Stage) -> carla.ActorSnapshot:
    """How a car stands in the newest frame."""
    return stage.world.get_snapshot().find(stage.vehicle.id)


def of_car(stage: Stage) -> Any:
    """The car."""
    return stage.vehicle


CALLS: dict[str, Call] = {
    **fields(
        "Actor",
        of_car,
        id=lambda found: found > 0,
        type_id="vehicle.lincoln.mkz_2020",
        is_alive=True,
        is_active=True,
        is_dormant=False,
        actor_state=carla.ActorState.Active,
        parent=None,
        attributes=lambda found: found["role_name"] == "hero",
        semantic_tags=lambda tags: int(carla.CityObjectLabel.Car) in list(tags),
        bounding_box=lambda box: 2.0 < box.extent.x < 3.0,
    ),
    "Actor.__str__": lambda s: "vehicle.lincoln.mkz_2020" in str(s.vehicle),
    "Actor.get_world": lambda s: s.vehicle.get_world().id == s.world.id,
    "Actor.get_location": lambda s: s.vehicle.get_location().distance(s.waypoint.transform.location) < 2.0,
    "Actor.get_transform": lambda s: s.vehicle.get_transform().location == s.vehicle.get_location(),
    "Actor.get_velocity": lambda s: s.vehicle.get_velocity().length() < 3.0,
    "Actor.get_acceleration": lambda s: s.vehicle.get_acceleration().length() < 30.0,
    "Actor.get_angular_velocity": lambda s: s.vehicle.get_angular_velocity().length() < 60.0,
    "Actor.set_location": lambda s: moved_to(s, "location"),
    "Actor.set_transform": lambda s: moved_to(s, "transform"),
    "Actor.set_target_velocity": lambda s: after(
        s,
        lambda: passing(s).set_target_velocity(passing(s).get_transform().get_forward_vector() * 5.0),
        lambda: passing(s).get_velocity().length() > 4.0,
    ),
    "Actor.set_target_angular_velocity": lambda s: after(
        s,
        lambda: passing(s).set_target_angular_velocity(carla.Vector3D(z=20.0)),
        lambda: passing(s).get_angular_velocity().z > 1.0,
    ),
    "Actor.enable_constant_velocity": lambda s: after(
        s,
        lambda: passing(s).enable_constant_velocity(carla.Vector3D(x=3.0)),
        lambda: passing(s).get_velocity().dot_2d(passing(s).get_transform().get_forward_vector()) > 2.8,
    ),
    "Actor.disable_constant_velocity": lambda s: passing(s).disable_constant_velocity(),
    "Actor.add_impulse": lambda s: passing(s).add_impulse(carla.Vector3D(x=500.0)),
    "Actor.add_force": lambda s: passing(s).add_force(carla.Vector3D(x=500.0)),
    "Actor.add_angular_impulse": lambda s: passing(s).add_angular_impulse(carla.Vector3D(z=5.0)),
    "Actor.add_torque": lambda s: passing(s).add_torque(carla.Vector3D(z=5.0)),
    "Actor.set_enable_gravity": lambda s: thrown(s).set_enable_gravity(True),
    "Actor.set_simulate_physics": lambda s: thrown(s).set_simulate_physics(True),
    "Actor.set_collisions": lambda s: thrown(s).set_collisions(True),
    "Actor.destroy": destroyed,
    "Actor.get_bone_names": lambda s: BONE in s.walker.get_bone_names(),
    "Actor.get_bone_world_transforms": lambda s: (
        len(s.walker.get_bone_world_transforms()) == len(s.walker.get_bone_names())
    ),
    "Actor.get_bone_relative_transforms": lambda s: (
        len(s.walker.get_bone_relative_transforms()) == len(s.walker.get_bone_names())
    ),
    "Actor.get_component_names": lambda s: len(s.vehicle.get_component_names()) > 0,
    "Actor.get_component_world_transform": lambda s: isinstance(
        s.vehicle.get_component_world_transform(s.vehicle.get_component_names()[0]), carla.Transform
    ),
    "Actor.get_component_relative_transform": lambda s: isinstance(
        s.vehicle.get_component_relative_transform(s.vehicle.get_component_names()[0]), carla.Transform
    ),
    "Actor.get_socket_names": lambda s: isinstance(list(s.vehicle.get_socket_names()), list),
    "Actor.get_socket_world_transforms": lambda s: (
        len(s.vehicle.get_socket_world_transforms()) == len(s.vehicle.get_socket_names())
    ),
    "Actor.get_socket_relative_transforms": lambda s: (
        len(s.vehicle.get_socket_relative_transforms()) == len(s.vehicle.get_socket_names())
    ),
    "ActorList.filter": lambda s: len(s.world.get_actors().filter("traffic.*")) > 10,
    "ActorList.find": lambda s: s.world.get_actors().find(s.vehicle.id).id == s.vehicle.id,
    "ActorList.__getitem__": lambda s: s.world.get_actors()[0].id > 0,
    "ActorList.__iter__": lambda s: s.vehicle.id in {found.id for found in s.world.get_actors()},
    "ActorList.__len__": lambda s: len(s.world.get_actors()) > 10,
    "ActorList.__str__": lambda s: len(str(s.world.get_actors())) > 0,
    "ActorSnapshot.id": lambda s: snapshot(s).id == s.vehicle.id,
    "ActorSnapshot.get_transform": lambda s: snapshot(s).get_transform() == s.vehicle.get_transform(),
    "ActorSnapshot.get_velocity": lambda s: snapshot(s).get_velocity() == s.vehicle.get_velocity(),
    "ActorSnapshot.get_acceleration": lambda s: snapshot(s).get_acceleration() == s.vehicle.get_acceleration(),
    "ActorSnapshot.get_angular_velocity": lambda s: (
        snapshot(s).get_angular_velocity() == s.vehicle.get_angular_velocity()
    ),
    "ActorSnapshot.__str__": lambda s: len(str(snapshot(s))) > 0,
    "BlueprintLibrary.filter": lambda s: len(s.world.get_blueprint_library().filter("walker.*")) > 40,
    "BlueprintLibrary.filter_by_attribute": lambda s: (
        len(s.world.get_blueprint_library().filter_by_attribute("number_of_wheels", "2")) > 3
    ),
    "BlueprintLibrary.find": lambda s: s.world.get_blueprint_library().find("sensor.other.imu").id.endswith("imu"),
    "BlueprintLibrary.__getitem__": lambda s: len(s.world.get_blueprint_library()[0].id) > 0,
    "BlueprintLibrary.__iter__": lambda s: len(list(s.world.get_blueprint_library())) > 150,
    "BlueprintLibrary.__len__": lambda s: len(s.world.get_blueprint_library()) > 150,
    "BlueprintLibrary.__str__": lambda s: "vehicle" in str(s.world.get_blueprint_library()),
    **fields("ActorBlueprint", blueprint, id="vehicle.lincoln.mkz_2020", tags=lambda tags: "lincoln" in list(tags)),
    "ActorBlueprint.has_attribute": lambda s: blueprint(s).has_attribute("color"),
    "ActorBlueprint.has_tag": lambda s: blueprint(s).has_tag("vehicle"),
    "ActorBlueprint.match_tags": lambda s: blueprint(s).match_tags("vehicle.lincoln.*"),
    "ActorBlueprint.get_attribute": lambda s: blueprint(s).get_attribute("base_type").as_str() == "car",
    "ActorBlueprint.set_attribute": painted,
    "ActorBlueprint.__iter__": lambda s: "color" in {found.id for found in blueprint(s)},
    "ActorBlueprint.__len__": lambda s: len(blueprint(s)) > 5,
    "ActorBlueprint.__str__": lambda s: "mkz_2020" in str(blueprint(s)),
    **fields(
        "ActorAttribute",
        attribute,
        id="color",
        is_modifiable=True,
        type=carla.ActorAttributeType.RGBColor,
        recommended_values=lambda values: len(list(values)) > 0,
    ),
    "ActorAttribute.as_bool": lambda s: attribute(s, "has_lights").as_bool(),
    "ActorAttribute.as_color": lambda s: isinstance(attribute(s).as_color(), carla.Color),
    "ActorAttribute.as_float": lambda s: (
        s.world.get_blueprint_library().find("sensor.other.obstacle").get_attribute("distance").as_float()
        == pytest.approx(5.0)
    ),
    "ActorAttribute.as_int": lambda s: number(s).as_int() == 4,
    "ActorAttribute.as_str": lambda s: attribute(s, "base_type").as_str() == "car",
    "ActorAttribute.__bool__": lambda s: bool(attribute(s, "has_lights")),
    "ActorAttribute.__nonzero__": lambda s: attribute(s, "has_lights").__nonzero__(),
    "ActorAttribute.__int__": lambda s: int(number(s)) == 4,
    "ActorAttribute.__float__": lambda s: (
        float(s.world.get_blueprint_library().find("sensor.other.obstacle").get_attribute("distance")) == 5.0
    ),
    "ActorAttribute.__eq__": lambda s: attribute(s, "base_type") == "car",
    "ActorAttribute.__ne__": lambda s: attribute(s, "base_type") != "bus",
    "ActorAttribute.__str__": lambda s: "number_of_wheels" in str(number(s)),
}
