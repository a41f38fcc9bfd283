"""Lots lie behind pavements, free of roads and of each other."""

import math

import numpy as np

from linden.maps.facts import derive
from linden.maps.lot_cutting import cut_lots
from linden.maps.opendrive.parse import parse
from linden.maps.records import LOT_DEPTH_M, LOT_WIDTH_M
from opendrive_texts import lane, line, opendrive, road, section, street_through_junction

PAVED = {"left": lane(2, "sidewalk", 1.5) + lane(1), "right": lane(-1) + lane(-2, "sidewalk", 1.5)}


def lots_of(text: str) -> np.ndarray:
    facts = derive(text)
    assert facts.lots.tobytes() == cut_lots(parse(text), facts.ground).tobytes()
    return facts.lots


def test_lots_line_a_street_behind_its_pavements_and_face_it() -> None:
    lots = lots_of(opendrive(road(7, 100.0, line(0, 0, 0, 0, 100), section(**PAVED))))
    assert len(lots) == 2 * ((100 - 6) // LOT_WIDTH_M)
    np.testing.assert_allclose(np.abs(lots["front_m"][:, 1]), 5.0, atol=1e-6)
    np.testing.assert_allclose(np.sin(lots["yaw_rad"]), np.sign(lots["front_m"][:, 1]), atol=1e-6)
    assert set(lots["road_id"].tolist()) == {7}
    for side in (-1.0, 1.0):
        along = np.sort(lots["front_m"][np.sign(lots["front_m"][:, 1]) == side, 0])
        np.testing.assert_allclose(np.diff(along), LOT_WIDTH_M, atol=1e-6)


def test_a_street_without_pavements_has_none() -> None:
    assert len(lots_of(opendrive(road(1, 100.0, line(0, 0, 0, 0, 100), section(left=lane(1), right=lane(-1)))))) == 0
    assert len(lots_of(opendrive())) == 0


def test_there_is_none_where_another_street_runs_close_behind() -> None:
    near = 10.0 + 0.5 * LOT_DEPTH_M
    streets = [road(n, 100.0, line(0, 0, y, 0, 100), section(**PAVED)) for n, y in ((1, 0.0), (2, near))]
    lots = lots_of(opendrive(*streets))
    assert len(lots) > 0
    assert not ((lots["front_m"][:, 1] < 0.0) & (lots["front_m"][:, 1] > -near)).any()  # y points south


def test_streets_that_meet_share_no_land() -> None:
    """On the corner both have pavements that lead there; the first one has the lot."""
    across = road(2, 100.0, line(0, -12.0, -112.0, math.pi / 2, 100), section(**PAVED))
    lots = lots_of(opendrive(road(1, 100.0, line(0, 0, 0, 0, 100), section(**PAVED)), across))
    middles = lots["front_m"] + 0.5 * LOT_DEPTH_M * np.column_stack([np.cos(lots["yaw_rad"]), np.sin(lots["yaw_rad"])])
    apart = np.hypot(*(middles[:, None] - middles[None]).transpose(2, 0, 1)) + 1e9 * np.eye(len(lots))
    assert {1, 2} == set(lots["road_id"].tolist())
    assert apart.min() > LOT_WIDTH_M - 0.5


def test_none_lies_in_a_junction() -> None:
    lots = lots_of(street_through_junction())
    assert len(lots) > 0
    assert not ((lots["front_m"][:, 0] > 44.0) & (lots["front_m"][:, 0] < 76.0)).any()
