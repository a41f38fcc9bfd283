"""Claims about where lanes lie: LibCarla reads the same texts, random ones and Linden's."""

import math
from importlib import resources

import carla
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linden.maps.opendrive.evaluate.tables import LanePlaces, Tables, tables_of
from linden.maps.opendrive.parse import parse
from opendrive_texts import lane, line, opendrive, road, section

LINDEN = (resources.files("linden") / "data" / "Linden.xodr").read_text()


def cubic(tag: str, start: str, values: tuple[float, ...]) -> str:
    coefficients = " ".join(f'{name}="{value!r}"' for name, value in zip("abcd", values, strict=True))
    return f'<{tag} {start}="0" {coefficients}/>'


def small(limit: float) -> st.SearchStrategy[float]:
    return st.floats(-limit, limit).map(lambda value: round(value, 6))


@st.composite
def shapes(draw: st.DrawFn, length: float) -> str:
    match draw(st.sampled_from(["line", "arc", "spiral", "poly3", "arcLength", "normalized"])):
        case "line":
            return "<line/>"
        case "arc":
            return f'<arc curvature="{draw(st.floats(0.002, 0.1)) * draw(st.sampled_from([-1, 1]))!r}"/>'
        case "spiral":
            start, end = draw(small(0.05)), draw(small(0.05))
            return f'<spiral curvStart="{start!r}" curvEnd="{end + 0.06!r}"/>'
        case "poly3":
            return f'<poly3 a="0" b="0" c="{draw(small(0.005))!r}" d="{draw(small(1e-4))!r}"/>'
        case p_range:
            scale = 1.0 if p_range == "arcLength" else length
            c, d = draw(small(0.005)) * scale**2, draw(small(1e-4)) * scale**3
            cubics = f'aU="0" bU="{scale!r}" cU="0" dU="0" aV="0" bV="0" cV="{c!r}" dV="{d!r}"'
            return f'<paramPoly3 {cubics} pRange="{p_range}"/>'


@st.composite
def roads(draw: st.DrawFn) -> str:
    """One road of one geometry with everything that can bend its lanes."""
    length = draw(st.floats(12.0, 60.0).map(lambda value: round(value, 3)))
    heading, x, y = draw(small(3.1)), draw(small(200.0)), draw(small(200.0))
    sides = []
    for sign in (1, -1):
        count = draw(st.integers(1, 3))
        lanes = [
            lane(sign * nth, widths=cubic("width", "sOffset", (3.0 + draw(small(0.5)), draw(small(0.01)), 0.0, 0.0)))
            for nth in range(1, count + 1)
        ]
        sides.append("".join(lanes))
    elevation = cubic("elevation", "s", (draw(small(50.0)), draw(small(0.08)), draw(small(1e-3)), 0.0))
    offsets = cubic("laneOffset", "s", (draw(small(2.0)), draw(small(0.02)), 0.0, 0.0))
    plan = line(0.0, x, y, heading, length, draw(shapes(length)))
    return opendrive(
        road(5, length, plan, section(left=sides[0], right=sides[1]), elevation=elevation, offsets=offsets)
    )


def compare(tables: Tables, theirs: carla.Map, rows: np.ndarray, s_m: np.ndarray) -> tuple[LanePlaces, np.ndarray]:
    """Return our places and the differences: m in plan, m in height, m of width, degrees of heading."""
    ours = tables.lane_centres(rows, s_m)
    differences = []
    for nth, (row, s) in enumerate(zip(rows, s_m, strict=True)):
        there = tables.roads[tables.lanes["road"][row]]
        lane_id = int(tables.lanes["lane_id"][row])
        waypoint = theirs.get_waypoint_xodr(there.id, lane_id, float(s))
        assert waypoint is not None
        place, yaw = waypoint.transform.location, waypoint.transform.rotation.yaw
        turn = math.degrees(-ours.heading_rad[nth]) + (180.0 if lane_id > 0 else 0.0)
        differences.append(
            (
                math.hypot(place.x - ours.x_m[nth], place.y + ours.y_m[nth]),
                abs(place.z - ours.z_m[nth]),
                abs(waypoint.lane_width - ours.width_m[nth]),
                abs(math.remainder(yaw - turn, 360.0)),
            )
        )
    return ours, np.array(differences)


@settings(max_examples=150)
@given(roads(), st.lists(st.floats(0.01, 0.99), min_size=4, max_size=4))
def test_lanes_of_random_roads_lie_where_libcarla_has_them(text: str, shares: list[float]) -> None:
    tables = tables_of(parse(text))
    rows = np.repeat(np.arange(len(tables.lanes)), len(shares))
    s_m = np.tile(shares, len(tables.lanes)) * tables.road_length_m[0]
    _, differences = compare(tables, carla.Map("test", text), rows, s_m)
    plan_m, height_m, width_m, heading_deg = differences.max(axis=0)
    # LibCarla walks cubics by chords of half a metre, and in single precision
    assert plan_m < 0.02
    assert height_m < 1e-3
    assert width_m < 1e-3
    assert heading_deg < 0.5


@pytest.fixture(scope="module")
def linden_read_by_libcarla() -> carla.Map:
    return carla.Map("Linden", LINDEN)


def test_lanes_of_linden_lie_where_libcarla_has_them(linden_read_by_libcarla: carla.Map) -> None:
    tables = tables_of(parse(LINDEN))
    random = np.random.default_rng(2)
    rows = random.integers(0, len(tables.lanes), 2000)
    start, end = tables.lanes["start_m"][rows], tables.lanes["end_m"][rows]
    s_m = start + random.uniform(0.001, 0.999, len(rows)) * (end - start)
    _, differences = compare(tables, linden_read_by_libcarla, rows, s_m)
    plan_m, height_m, width_m, heading_deg = differences.max(axis=0)
    assert plan_m < 0.01
    assert height_m < 1e-3
    assert width_m < 1e-3
    assert heading_deg < 0.5


def test_bordered_lanes_end_where_their_border_is() -> None:
    border = '<border sOffset="0" a="-4" b="0" c="0" d="0"/>'
    right = lane(-1).replace("<width", "<unused").replace("</link>", f"</link>{border}") + lane(-2, width=2.0)
    tables = tables_of(parse(opendrive(road(1, 10.0, line(0, 0, 0, 0, 10), section(right=right)))))
    inner, outer = tables.lane_sides(np.array([0, 1]), np.array([5.0, 5.0]))
    assert inner.tolist() == [0.0, -4.0]
    assert outer.tolist() == [-4.0, -6.0]


@given(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2), st.floats(1.0, 80.0))
def test_a_spiral_is_the_integral_of_its_heading(start: float, end: float, length: float) -> None:
    spiral = f'<spiral curvStart="{start!r}" curvEnd="{end!r}"/>'
    text = opendrive(road(1, length, line(0.0, 0.0, 0.0, 0.3, length, spiral), section(right=lane(-1))))
    pose = tables_of(parse(text)).curves.pose(np.array([0]), np.array([length]))
    way = (np.arange(20000) + 0.5) * (length / 20000)  # the obvious version: many small steps
    heading = 0.3 + start * way + 0.5 * (end - start) / length * way**2
    assert float(pose.x_m[0]) == pytest.approx(float(np.cos(heading).mean() * length), abs=1e-5)
    assert float(pose.y_m[0]) == pytest.approx(float(np.sin(heading).mean() * length), abs=1e-5)


def test_a_cubic_is_walked_by_arc_length_whatever_its_parameter_does() -> None:
    # a straight line whose parameter runs ever faster: u = p³
    plan = line(0.0, 0.0, 0.0, 0.0, 27.0, '<paramPoly3 bU="9" cU="9" dU="9" pRange="normalized"/>')
    curves = tables_of(parse(opendrive(road(1, 27.0, plan, section(right=lane(-1)))))).curves
    s_m = np.linspace(0.0, 27.0, 10)
    assert curves.pose(np.zeros(10, np.int64), s_m).x_m == pytest.approx(s_m, abs=1e-9)
