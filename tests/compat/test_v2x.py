"""Messages between vehicles through the official client, which judges their bytes."""

import math
import queue
import time
from collections.abc import Iterator
from itertools import pairwise
from typing import Any, NamedTuple

import carla
import pytest
from pycrate_asn1dir.ITS_CAM_2 import CAM_PDU_Descriptions  # an implementation of ETSI's ASN.1 that none of us wrote

from spawn_points import spawn_point

FRAME_S = 0.05
QUIET = {"use_etsi_fading": "false"}


class Radio(NamedTuple):
    """A sensor that is listened to, and what has come."""

    sensor: carla.ServerSideSensor
    events: "queue.Queue[Any]"

    def heard(self) -> list[Any]:
        """What has come since the last call; the last may be on its way still."""
        time.sleep(0.5)
        return [self.events.get_nowait() for _ in range(self.events.qsize())]


class Street:
    """A world, a place in it, and the radios there."""

    def __init__(self, world: carla.World) -> None:
        self.world, self.point, self.radios = world, spawn_point(world, 100), []

    def car(self, ahead_m: float, name: str = "vehicle.tesla.model3") -> carla.Actor:
        location = self.point.location + self.point.get_forward_vector() * ahead_m + carla.Location(z=0.3)
        pose = carla.Transform(location, self.point.rotation)
        return self.world.spawn_actor(self.world.get_blueprint_library().find(name), pose)

    def radio(self, car: carla.Actor | None, name: str = "v2x", **attributes: str) -> Radio:
        blueprint = self.world.get_blueprint_library().find(f"sensor.other.{name}")
        for key, value in {**QUIET, **attributes}.items():
            blueprint.set_attribute(key, value)
        sensor = self.world.spawn_actor(blueprint, carla.Transform(carla.Location(z=2.0)), attach_to=car)
        radio = Radio(sensor, queue.Queue())
        sensor.listen(radio.events.put)
        self.radios.append(radio)
        return radio

    def tick(self, frames: int) -> None:
        for _ in range(frames):
            self.world.tick()


@pytest.fixture
def street(world: carla.World) -> Iterator[Street]:
    street = Street(world)
    yield street
    for radio in street.radios:
        radio.sensor.stop()


def content(message: Any) -> dict[str, Any]:
    return message.get()["Message"]["Message"]["CAM Parameters"]


def moving_part(message: Any) -> dict[str, Any]:
    return content(message)["High Frequency Container"]["Basic Vehicle Container High Frequency"]


def test_a_vehicle_hears_what_another_tells_of_itself(street: Street) -> None:
    listener, speaker = street.car(0.0), street.car(12.0, "vehicle.easymile.ez10")
    street.tick(40)
    ear, _ = street.radio(listener), street.radio(speaker)
    street.tick(5)
    (event,) = ear.heard()
    assert isinstance(event, carla.CAMEvent)
    assert event.get_message_count() == len(event) == len(list(event)) == 1
    message = event[0]
    assert message.get()["Message"]["Header"] == {
        "Protocol Version": 2,
        "Message ID": "CAM",
        "Station ID": speaker.id,
    }
    assert message.power == message.get()["Power"]
    assert content(message)["Basic Container"]["Station Type"] == "Bus"
    place = content(message)["Basic Container"]["Reference Position"]
    expected = street.world.get_map().transform_to_geolocation(speaker.get_location())
    assert place["Latitude"] == pytest.approx(expected.latitude * 1e7, abs=2)
    assert place["Longitude"] == pytest.approx(expected.longitude * 1e7, abs=2)
    told = moving_part(message)
    assert told["Heading"]["Value"] == pytest.approx((speaker.get_transform().rotation.yaw + 90.0) % 360.0 * 10, abs=2)
    assert told["Vehicle Length"]["Value"] == round(speaker.bounding_box.extent.x * 20.0)
    assert told["Vehicle Width"] == round(speaker.bounding_box.extent.y * 20.0)
    assert told["Speed"]["Value"] == pytest.approx(100.0 * speaker.get_velocity().length(), abs=3)
    assert abs(told["Vertical Acceleration"]["Value"]) <= 1
    slow = content(message)["Low Frequency Container"]["Basic Vehicle Low Frequency"]
    assert slow == {"Vehicle Role": "Public Transport", "Exterior Light": 0, "Path History": None}


def test_messages_are_rare_at_rest_and_frequent_when_driving(street: Street) -> None:
    ear, driver = street.radio(street.car(0.0)), street.car(15.0)
    street.radio(driver)
    street.tick(100)
    at_rest = ear.heard()
    assert [later.frame - earlier.frame for earlier, later in pairwise(at_rest)][-3:] == [20] * 3
    forward = driver.get_transform().get_forward_vector()
    driver.set_target_velocity(forward * 12.0)
    speeds = []
    for _ in range(40):
        street.world.tick()
        driver.set_target_velocity(forward * 12.0)
        speeds.append(driver.get_velocity().length())
    driving = ear.heard()
    assert len(driving) >= 2.0 * speeds[-1] / 4.6
    apart_s = [later.timestamp - earlier.timestamp for earlier, later in pairwise(driving[1:])]
    assert all(speeds[-1] * gap_s + 0.6 >= 4.0 and gap_s < 0.5 for gap_s in apart_s)
    assert moving_part(driving[-1][0])["Speed"]["Value"] == pytest.approx(100.0 * speeds[-1], abs=60)
    with_slow = [
        event.timestamp
        for event in driving
        if content(event[0])["Low Frequency Container"]["Low Frequency Container Present"] != "No Container Present"
    ]
    assert 2 <= len(with_slow) < len(driving)
    assert all(later - earlier >= 0.5 - 1e-6 for earlier, later in pairwise(with_slow))


@pytest.mark.parametrize("ahead_m", [15.0, 30.0])
def test_power_is_the_models(street: Street, ahead_m: float) -> None:
    listener, speaker = street.car(0.0), street.car(ahead_m)
    street.tick(40)
    ear, _ = street.radio(listener), street.radio(speaker)
    street.tick(2)
    distance_m = listener.get_location().distance(speaker.get_location())
    expected = 21.5 + 10.0 - (32.4 + 20.0 * math.log10(distance_m) + 20.0 * math.log10(5.9))
    assert ear.heard()[0][0].power == pytest.approx(expected, abs=0.05)


def test_a_truck_in_between_weakens_a_message(street: Street) -> None:
    listener, speaker = street.car(0.0), street.car(30.0)
    street.car(15.0, "vehicle.carlamotors.european_hgv")
    street.tick(40)
    ear, _ = street.radio(listener), street.radio(speaker)
    street.tick(2)
    distance_m = listener.get_location().distance(speaker.get_location())
    free = 21.5 + 10.0 - (32.4 + 20.0 * math.log10(distance_m) + 20.0 * math.log10(5.9))
    assert free - 30.0 < ear.heard()[0][0].power < free - 15.0


def test_texts_go_both_ways(street: Street) -> None:
    here, there = street.car(0.0), street.car(15.0)
    first, second = street.radio(here, "v2x_custom"), street.radio(there, "v2x_custom")
    street.tick(2)
    first.sensor.send("hidden pedestrian: brake")
    street.tick(2)
    (event,) = second.heard()
    assert isinstance(event, carla.CustomV2XEvent)
    assert [each.get()["Message"] for each in event] == [
        {
            "Header": {"Protocol Version": 2, "Message ID": "CUSTOM", "Station ID": here.id},
            "Message": "hidden pedestrian: brake",
        }
    ]
    assert event[0].power == event[0].get()["Power"] > -60.0
    second.sensor.send("understood")
    second.sensor.send("x" * 100)  # refused, as the log says: CARLA's client does not wait for the answer
    street.tick(2)
    assert [each.get()["Message"]["Message"] for event in first.heard() for each in event] == ["understood"]


def test_with_a_sensor_tick_an_event_comes_in_each_frame_and_may_be_empty(street: Street) -> None:
    ear, voice = street.radio(street.car(0.0), sensor_tick="0.05"), street.radio(street.car(15.0))
    patient = street.radio(None, "v2x_custom", sensor_tick="0.05")
    street.tick(30)
    told, silent = ear.heard(), patient.heard()
    for events in (told, silent):
        assert [later.frame - earlier.frame for earlier, later in pairwise(events)] == [1] * 29
    assert {len(event) for event in told} == {0, 1}
    assert [list(event) for event in silent] == [[]] * 30
    assert voice.sensor.is_alive


def test_a_pole_is_a_road_side_unit(street: Street) -> None:
    ear = street.radio(street.car(0.0))
    pole = street.world.spawn_actor(
        street.world.get_blueprint_library().find("sensor.other.v2x"),
        carla.Transform(street.point.location + carla.Location(z=6.0)),
    )
    street.tick(2)
    (event,) = ear.heard()
    assert event[0].get()["Message"]["Header"]["Station ID"] == pole.id
    assert content(event[0])["Basic Container"]["Station Type"] == "Road Side Unit"
    assert content(event[0])["High Frequency Container"] == {
        "High Frequency Container Present": "RSU Container High Frequency",
        "RSU Container High Frequency": {"Protected Communication Zone": []},
    }


def test_a_traffic_light_that_carries_a_radio_does_not_hide_it(street: Street) -> None:
    light = street.world.get_actors().filter("traffic.traffic_light*")[0]
    mast = light.get_transform().location
    stop = light.get_stop_waypoints()[0].transform
    car = street.world.spawn_actor(
        street.world.get_blueprint_library().find("vehicle.tesla.model3"),
        carla.Transform(stop.location + carla.Location(z=0.3), stop.rotation),
    )
    street.tick(40)
    ear, _ = street.radio(car), street.radio(light)
    street.tick(2)
    message = ear.heard()[0][0]
    assert message.get()["Message"]["Header"]["Station ID"] == light.id
    antenna = car.get_location() + carla.Location(z=car.bounding_box.location.z + car.bounding_box.extent.z + 0.02)
    distance_m = antenna.distance(mast + carla.Location(z=2.0))
    expected = 21.5 + 10.0 - (32.4 + 20.0 * math.log10(distance_m) + 20.0 * math.log10(5.9))
    assert message.power == pytest.approx(expected, abs=0.05)


@pytest.mark.parametrize(
    ("attributes", "sentence"),
    [
        ({"frequency_ghz": "0"}, "'0' as frequency_ghz: expected at least 0.001"),
        ({"gen_cam_min": "2.0"}, "gen_cam_min must not be above gen_cam_max"),
    ],
)
def test_attributes_that_mean_nothing_get_a_sentence(street: Street, attributes: dict[str, str], sentence: str) -> None:
    with pytest.raises(RuntimeError, match=sentence):
        street.radio(street.car(0.0), **attributes)


CONFIDENCE = {
    "Equal or With in Zero Point One Degree": 1,
    "Equal or With in One Degree": 10,
    "Equal or With in One Centimeter per Sec": 1,
    "No Trailer Present": "noTrailerPresent",
    "Semi Axis Length Unavailable": 4095,
    "Heading Unavailable": 3601,
}
STATION = {"Passenger Car": 5, "Bus": 6, "Motorcycle": 4, "Cyclist": 2, "Light Truck": 7, "Special Vehicle": 10}
ROLE = {"Default": "default", "Public Transport": "publicTransport", "Emergency": "emergency", "Taxi": "taxi"}


def in_asn1(message: dict[str, Any]) -> dict[str, Any]:
    """A message of CARLA's client by the names of ETSI's ASN.1; its dicts leave some constants and the altitude out."""
    parameters = message["Message"]["CAM Parameters"]
    basic, fast = parameters["Basic Container"], parameters["High Frequency Container"]
    place, told = basic["Reference Position"], fast["Basic Vehicle Container High Frequency"]
    ellipse = place["Position Confidence Eliipse"]
    slow = parameters["Low Frequency Container"].get("Basic Vehicle Low Frequency")

    def acceleration(name: str, words: str) -> dict[str, int]:
        return {
            f"{name}AccelerationValue": told[f"{words} Acceleration"]["Value"],
            f"{name}AccelerationConfidence": 102,
        }

    container = {
        "heading": {
            "headingValue": told["Heading"]["Value"],
            "headingConfidence": CONFIDENCE[told["Heading"]["Confidence"]],
        },
        "speed": {"speedValue": told["Speed"]["Value"], "speedConfidence": CONFIDENCE[told["Speed"]["Confidence"]]},
        "driveDirection": ("forward", "backward")[told["Drive Direction"]],
        "vehicleLength": {
            "vehicleLengthValue": told["Vehicle Length"]["Value"],
            "vehicleLengthConfidenceIndication": CONFIDENCE[told["Vehicle Length"]["Confidence"]],
        },
        "vehicleWidth": told["Vehicle Width"],
        "longitudinalAcceleration": acceleration("longitudinal", "Longitudinal"),
        "curvature": {"curvatureValue": told["Curvature"]["Value"], "curvatureConfidence": "unavailable"},
        "curvatureCalculationMode": ("yawRateUsed", "yawRateNotUsed", "unavailable")[
            told["Curvature Calculation Mode"]
        ],
        "yawRate": {"yawRateValue": told["Yaw Rate"]["Value"], "yawRateConfidence": "unavailable"},
        "accelerationControl": (told["Acceleration Control"] >> 1, 7),
        "lateralAcceleration": acceleration("lateral", "Lateral"),
        "verticalAcceleration": acceleration("vertical", "Vertical"),
    }
    found: dict[str, Any] = {
        "basicContainer": {
            "stationType": STATION[basic["Station Type"]],
            "referencePosition": {
                "latitude": place["Latitude"],
                "longitude": place["Longitude"],
                "positionConfidenceEllipse": {
                    "semiMajorConfidence": CONFIDENCE[ellipse["Semi Major Confidence"]],
                    "semiMinorConfidence": CONFIDENCE[ellipse["Semi Minor Confidence"]],
                    "semiMajorOrientation": CONFIDENCE[ellipse["Semi Major Orientation"]],
                },
                "altitude": {"altitudeValue": 800_001, "altitudeConfidence": "unavailable"},
            },
        },
        "highFrequencyContainer": ("basicVehicleContainerHighFrequency", container),
    }
    if slow is not None:
        found["lowFrequencyContainer"] = (
            "basicVehicleContainerLowFrequency",
            {
                "vehicleRole": ROLE[slow["Vehicle Role"]],
                "exteriorLights": (slow["Exterior Light"], 8),
                "pathHistory": [],
            },
        )
    head = message["Header"]
    return {
        "header": {"protocolVersion": head["Protocol Version"], "messageID": 2, "stationID": head["Station ID"]},
        "cam": {"generationDeltaTime": message["Message"]["Generation Delta Time"], "camParameters": found},
    }


@pytest.mark.parametrize(
    ("name", "station"),
    [
        ("vehicle.tesla.model3", 5),
        ("vehicle.easymile.ez10", 6),
        ("vehicle.kawasaki.ninja", 4),
        ("vehicle.carlamotors.firetruck", 10),
    ],
)
def test_an_independent_codec_encodes_and_decodes_what_arrives(street: Street, name: str, station: int) -> None:
    ear, driver = street.radio(street.car(0.0)), street.car(20.0, name)
    street.radio(driver)
    driver.apply_control(carla.VehicleControl(throttle=0.8, steer=0.3))
    street.tick(60)
    messages = [each.get()["Message"] for event in ear.heard() for each in event]
    assert len(messages) >= 5
    codec = CAM_PDU_Descriptions.CAM
    for message in messages:
        value = in_asn1(message)
        codec.set_val(value)  # refuses what lies outside the ranges
        data = codec.to_uper()
        codec.reset_val()
        codec.from_uper(data)
        assert codec.get_val() == value
        assert value["cam"]["camParameters"]["basicContainer"]["stationType"] == station
        assert 40 <= len(data) <= 60
