"""The satellite receiver against the official client's own conversion, and its errors against what was asked for."""

import carla
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linden.protocol.values.space import GeoLocation, Vector3D
from linden.sensors.devices.attributes import GnssSpec
from linden.sensors.devices.gnss import geolocation, measure

ORIGINS = [(39.99, -82.98), (0.0, 0.0), (-33.9, 151.2), (70.0, 179.9)]


def client_map(origin_deg: tuple[float, float]) -> carla.Map:
    latitude, longitude = origin_deg
    return carla.Map(
        "here",
        f"""<?xml version="1.0"?><OpenDRIVE><header revMajor="1" revMinor="4"><geoReference><![CDATA[+proj=tmerc
 +lat_0={latitude} +lon_0={longitude} ]]></geoReference></header></OpenDRIVE>""",
    )


CLIENT_MAPS = {origin: client_map(origin) for origin in ORIGINS}


@given(
    st.sampled_from(ORIGINS),
    st.floats(-20_000.0, 20_000.0, width=32),
    st.floats(-20_000.0, 20_000.0, width=32),
    st.floats(-100.0, 1000.0, width=32),
)
def test_a_place_lies_where_the_client_says_it_lies(origin: tuple[float, float], x: float, y: float, z: float) -> None:
    expected = CLIENT_MAPS[origin].transform_to_geolocation(carla.Location(x, y, z))
    found = geolocation(Vector3D(x, y, z), *origin)
    assert found.latitude == pytest.approx(expected.latitude, abs=1e-11)  # a micrometre on the ground
    assert found.longitude == pytest.approx(expected.longitude, abs=1e-11)
    assert found.altitude == expected.altitude


def test_the_origin_lies_at_the_maps_origin_and_latitude_grows_southwards() -> None:
    assert geolocation(Vector3D(), 40.0, -83.0) == pytest.approx((40.0, -83.0, 0.0))
    assert geolocation(Vector3D(0.0, 100.0, 0.0), 40.0, -83.0).latitude > 40.0
    assert geolocation(Vector3D(100.0, 0.0, 0.0), 40.0, -83.0).longitude > -83.0


def test_without_noise_a_receiver_is_exact() -> None:
    assert measure(GnssSpec(), 5, Vector3D(3.0, 4.0, 5.0), (40.0, -83.0)) == geolocation(Vector3D(3, 4, 5), 40.0, -83.0)


def test_a_bias_is_added_to_every_measurement() -> None:
    spec = GnssSpec(bias=GeoLocation(0.25, -0.5, 3.0))
    for number in range(3):
        assert measure(spec, number, Vector3D(), (40.0, -83.0)) == pytest.approx((40.25, -83.5, 3.0))


def test_errors_have_the_deviation_asked_for_and_no_mean() -> None:
    spec = GnssSpec(deviation=GeoLocation(1e-5, 2e-5, 0.5), seed=11)
    found = np.array([measure(spec, number, Vector3D(), (40.0, -83.0)) for number in range(4000)])
    errors = (found - [40.0, -83.0, 0.0]) / spec.deviation
    assert np.abs(errors.mean(axis=0)).max() < 4.0 / np.sqrt(4000)  # four standard errors of the mean
    assert np.abs(errors.std(axis=0) - 1.0).max() < 4.0 / np.sqrt(2 * 4000)  # likewise of the deviation
    assert np.abs(np.corrcoef(errors.T) - np.eye(3)).max() < 4.0 / np.sqrt(4000)
