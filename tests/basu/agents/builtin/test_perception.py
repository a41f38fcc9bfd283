"""Claims about what the driving agents read of their own vehicle and of the lights."""

from types import SimpleNamespace

import carla
import pytest

from basu.agents.builtin.perception import Lights, see_ego
from basu.agents.builtin.rules.traffic_lights import Light


def seen(number: int, x_m: float, y_m: float, yaw_deg: float = 0.0) -> SimpleNamespace:
    """One actor of a snapshot."""
    return SimpleNamespace(
        id=number,
        get_transform=lambda: carla.Transform(carla.Location(x_m, y_m, 0.0), carla.Rotation(yaw=yaw_deg)),
        get_velocity=lambda: carla.Vector3D(3.0, 4.0, 0.0),
        get_angular_velocity=lambda: carla.Vector3D(0.0, 0.0, 90.0),
    )


def test_the_own_speed_is_that_along_the_vehicles_axis() -> None:
    snapshot = SimpleNamespace(timestamp=SimpleNamespace(elapsed_seconds=7.5))
    ego = see_ego(snapshot, seen(1, 1.0, 2.0, 90.0), 3)
    assert ego[:3] == pytest.approx((7.5, 1.0, 2.0))
    assert ego.speed_mps == pytest.approx(4.0)
    assert ego.gear == 3


def test_lights_are_told_by_their_opendrive_id_and_a_missing_one_is_dark() -> None:
    states = {"12": carla.TrafficLightState.Red, "13": carla.TrafficLightState.Green, "14": carla.TrafficLightState.Off}

    def find(landmark_id: str) -> SimpleNamespace | None:
        state = states.get(landmark_id)
        return None if state is None else SimpleNamespace(get_state=lambda: state)

    lights = Lights(SimpleNamespace(get_traffic_light_from_opendrive_id=find), ["12", "13", "14", "99"])
    assert [lights.shows(i) for i in ("12", "13", "14", "99")] == [Light.RED, Light.GREEN, Light.DARK, Light.DARK]
