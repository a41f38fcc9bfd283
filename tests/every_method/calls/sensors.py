"""carla.Sensor: listening, and what a script can ask of one; events of the sensors that feel."""

from typing import Any

import carla

from every_method.call import Call, Defect
from every_method.entries import fields, missing
from every_method.stage import Stage

SCENE_COLOUR = carla.GBufferTextureID.SceneColor


def listened(stage: Stage) -> bool:
    """Whether a sensor sends what it measures."""
    sensor = stage.once("sensor to hear", lambda: stage.sensor("sensor.other.imu"))
    heard: list[int] = []
    sensor.listen(lambda event: heard.append(event.frame))
    stage.tick(3)
    return len(heard) >= 1


def heard(stage: Stage) -> Any:
    """The sensor that is listened to."""
    return stage.once("sensor to hear", lambda: stage.sensor("sensor.other.imu"))


def camera(stage: Stage) -> Any:
    """A camera: of any other sensor the client does not even ask for g-buffers."""
    return stage.once("camera", lambda: stage.sensor("sensor.camera.rgb", image_size_x="32", image_size_y="16"))


def radio(stage: Stage) -> Any:
    """A sender of messages: the client lets no other sensor send."""
    return stage.once("radio", lambda: stage.sensor("sensor.other.v2x_custom"))


def lane_sensor(stage: Stage) -> Any:
    """The sensor that the client computes by itself."""
    return stage.once("lane sensor", lambda: stage.sensor("sensor.other.lane_invasion"))


def crash(stage: Stage) -> None:
    """Let the car stand in the way of another one."""
    pose = stage.vehicle.get_transform()
    behind = carla.Transform(pose.location - pose.get_forward_vector() * 8.0 + carla.Vector3D(z=0.3), pose.rotation)
    other = stage.once(
        "who crashes",
        lambda: stage.world.spawn_actor(stage.world.get_blueprint_library().find("vehicle.audi.tt"), behind),
    )
    stage.tick(2)
    other.set_target_velocity(pose.get_forward_vector() * 12.0)


def cross_a_line(stage: Stage) -> None:
    """Let the car slide over the markings of its lane."""
    stage.vehicle.set_target_velocity(stage.vehicle.get_transform().get_right_vector() * 6.0)


def collision(stage: Stage) -> Any:
    """A collision."""
    return stage.event("sensor.other.collision", lambda: crash(stage))


def invasion(stage: Stage) -> Any:
    """A line crossed."""
    return stage.event("sensor.other.lane_invasion", lambda: cross_a_line(stage))


def obstacle(stage: Stage) -> Any:
    """Something ahead."""
    return stage.event("sensor.other.obstacle", lambda: crash(stage), distance="60", hit_radius="1")


def imu(stage: Stage) -> Any:
    """How a car is shaken."""
    return stage.event("sensor.other.imu")


def gnss(stage: Stage) -> Any:
    """Where a car is."""
    return stage.event("sensor.other.gnss")


def cam(stage: Stage) -> Any:
    """What vehicles tell each other."""
    return stage.event("sensor.other.v2x", lambda: second_radio(stage, "sensor.other.v2x"))


def custom(stage: Stage) -> Any:
    """What scripts tell each other."""

    def speak() -> None:
        second_radio(stage, "sensor.other.v2x_custom").send("hello")

    return stage.event("sensor.other.v2x_custom", speak)


def second_radio(stage: Stage, blueprint_id: str) -> Any:
    """Another car's."""
    other = stage.once("who talks", lambda: stage.spawn("vehicle.audi.a2", 4))
    return stage.once(f"radio {blueprint_id}", lambda: stage.sensor(blueprint_id, other))


def vectors(found: Any) -> bool:
    """Whether this is a vector."""
    return isinstance(found, carla.Vector3D)


CALLS: dict[str, Call] = {
    "Sensor.listen": listened,
    "Sensor.is_listening": lambda s: heard(s).is_listening(),
    "Sensor.stop": lambda s: heard(s).stop(),
    "Sensor.__str__": lambda s: "sensor.other.imu" in str(heard(s)),
    "ServerSideSensor.__str__": lambda s: "sensor.other.imu" in str(heard(s)),
    "ClientSideSensor.__str__": lambda s: "lane_invasion" in str(lane_sensor(s)),
    "LaneInvasionSensor.__str__": lambda s: "lane_invasion" in str(lane_sensor(s)),
    **missing(
        "Sensor", dict.fromkeys(("is_listening_gbuffer", "listen_to_gbuffer", "stop_gbuffer"), "cameras have it")
    ),
    "ServerSideSensor.is_listening_gbuffer": lambda s: heard(s).is_listening_gbuffer(SCENE_COLOUR) is False,
    "ServerSideSensor.listen_to_gbuffer": lambda s: camera(s).listen_to_gbuffer(SCENE_COLOUR, print),
    "ServerSideSensor.stop_gbuffer": lambda s: camera(s).stop_gbuffer(SCENE_COLOUR),
    "ServerSideSensor.enable_gbuffers": lambda s: heard(s).enable_gbuffers(True),
    "ServerSideSensor.enable_for_ros": lambda s: heard(s).enable_for_ros(),
    "ServerSideSensor.disable_for_ros": lambda s: heard(s).disable_for_ros(),
    "ServerSideSensor.is_enabled_for_ros": lambda s: heard(s).is_enabled_for_ros() is False,
    "ServerSideSensor.send": lambda s: radio(s).send("hello"),
    "ServerSideSensor.set_ignored_vehicles": lambda s: heard(s).set_ignored_vehicles([s.vehicle.id]),
    "ServerSideSensor.get_ignored_vehicles": Defect(
        lambda s: heard(s).get_ignored_vehicles(),
        "TypeError",
        "the wheel cannot turn its own answer into Python's",
    ),
    **fields(
        "SensorData",
        imu,
        frame=lambda number: number > 0,
        frame_number=lambda number: number > 0,
        timestamp=lambda when_s: when_s > 0.0,
        transform=lambda pose: isinstance(pose, carla.Transform),
    ),
    **fields("IMUMeasurement", imu, accelerometer=vectors, gyroscope=vectors, compass=lambda rad: 0.0 <= rad <= 6.29),
    "IMUMeasurement.__str__": lambda s: "IMU" in str(imu(s)),
    **fields(
        "GnssMeasurement",
        gnss,
        latitude=lambda deg: abs(deg) <= 90.0,
        longitude=lambda deg: abs(deg) <= 180.0,
        altitude=lambda high_m: abs(high_m) < 9000.0,
    ),
    "GnssMeasurement.__str__": lambda s: "Gnss" in str(gnss(s)),
    **fields(
        "CollisionEvent",
        collision,
        actor=lambda found: found.type_id == "vehicle.lincoln.mkz_2020",
        other_actor=lambda found: found.type_id == "vehicle.audi.tt",
        normal_impulse=vectors,
    ),
    "CollisionEvent.__str__": lambda s: "Collision" in str(collision(s)),
    "LaneInvasionEvent.actor": Defect(
        lambda s: invasion(s).actor, "RuntimeError", "the sensor's parent is there all the same"
    ),
    "LaneInvasionEvent.crossed_lane_markings": lambda s: len(invasion(s).crossed_lane_markings) > 0,
    "LaneInvasionEvent.__str__": lambda s: "LaneInvasion" in str(invasion(s)),
    **fields(
        "ObstacleDetectionEvent",
        obstacle,
        actor=lambda found: found.type_id == "sensor.other.obstacle",
        other_actor=lambda found: len(found.type_id) > 0,
        distance=lambda far_m: 0.0 <= far_m <= 60.0,
    ),
    "ObstacleDetectionEvent.__str__": lambda s: "Obstacle" in str(obstacle(s)),
    "CAMEvent.get_message_count": lambda s: cam(s).get_message_count() > 0,
    "CAMEvent.__getitem__": lambda s: isinstance(cam(s)[0], carla.CAMMessage),
    "CAMEvent.__iter__": lambda s: len(list(cam(s))) > 0,
    "CAMEvent.__len__": lambda s: len(cam(s)) > 0,
    "CAMMessage.__init__": lambda _: isinstance(carla.CAMMessage(), carla.CAMMessage),
    "CAMMessage.get": lambda s: isinstance(cam(s)[0].get(), dict),
    "CAMMessage.power": lambda s: cam(s)[0].power < 100.0,
    "CAMMessage.__str__": lambda s: len(str(cam(s)[0])) > 0,
    "CustomV2XEvent.get_message_count": lambda s: custom(s).get_message_count() > 0,
    "CustomV2XEvent.__getitem__": lambda s: isinstance(custom(s)[0], carla.CustomV2XData),
    "CustomV2XEvent.__iter__": lambda s: len(list(custom(s))) > 0,
    "CustomV2XEvent.__len__": lambda s: len(custom(s)) > 0,
    "CustomV2XData.__init__": lambda _: isinstance(carla.CustomV2XData(), carla.CustomV2XData),
    "CustomV2XData.get": lambda s: isinstance(custom(s)[0].get(), dict),
    "CustomV2XData.power": lambda s: custom(s)[0].power < 100.0,
    "CustomV2XData.__str__": lambda s: len(str(custom(s)[0])) > 0,
}
