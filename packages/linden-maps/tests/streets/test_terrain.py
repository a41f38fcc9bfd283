"""Claims about measured ground: a hilly landscape with a formula, written as GeoTIFF and as LAS, and read back."""

import math
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import carla
import laspy
import numpy as np
import pytest
import rasterio
from affine import Affine
from pyproj import CRS, Transformer

from linden.cli import main
from linden.errors import UserError
from linden.maps.opendrive.parse import parse
from linden_maps.statistics import count
from linden_maps.streets.build import assembled, off_ground_m
from linden_maps.streets.street_facts import Facts
from linden_maps.streets.terrain import with_terrain
from linden_maps.streets.writing import text

UTM = "EPSG:32617"  # of 83 degrees west
HALF_M = 260.0
Hills = Callable[[np.ndarray, np.ndarray], np.ndarray]


def steep(east: np.ndarray, north: np.ndarray) -> np.ndarray:
    """Hills 5 m high, 400 m from top to top: grades up to 8 %."""
    return 250.0 + 5.0 * np.sin(2.0 * math.pi * east / 400.0) + 0.02 * north


def gentle(east: np.ndarray, north: np.ndarray) -> np.ndarray:
    """Hills 2 m high, 2 km from top to top: grades below 1 %."""
    return 250.0 + 2.0 * np.sin(2.0 * math.pi * (east + north) / 2000.0)


def middle() -> tuple[float, float]:
    """The sketch's origin in UTM."""
    east, north = Transformer.from_crs("EPSG:4326", UTM, always_xy=True).transform(-83.0, 40.0)
    return float(east), float(north)


def geotiff(file: Path, hills: Hills, *, half_m: float = HALF_M, crs: str | None = UTM, cell_m: float = 2.0) -> Path:
    """Write the hills about the sketch's origin; their formula counts from there."""
    east, north = middle()
    count = int(2 * half_m / cell_m)
    places = -half_m + cell_m * (np.arange(count) + 0.5)
    columns, rows = np.meshgrid(places, -places)
    transform = Affine(cell_m, 0.0, east - half_m, 0.0, -cell_m, north + half_m)
    with rasterio.open(
        file, "w", driver="GTiff", width=count, height=count, count=1, dtype="float32", crs=crs, transform=transform
    ) as raster:
        raster.write(hills(columns, rows).astype(np.float32), 1)
    return file


def expected(hills: Hills, x_m: float, y_m: float, facts: Facts) -> float:
    """The formula's height at a place of the map, by way of degrees."""
    frame = f"+proj=tmerc +lat_0={facts.latitude_deg} +lon_0={facts.longitude_deg} +k=1 +datum=WGS84 +units=m"
    east, north = Transformer.from_crs(CRS(frame), UTM, always_xy=True).transform(x_m, y_m)
    at_east, at_north = middle()
    return float(hills(np.array(east - at_east), np.array(north - at_north)))


@pytest.fixture
def facts(facts_of: Any, sketch: Any) -> Facts:
    return facts_of(sketch.crossing())


@pytest.fixture(autouse=True)
def own_projections(monkeypatch: pytest.MonkeyPatch) -> None:
    """Hide what an import of SUMO by another test has set: the rasters are written with rasterio's own projections."""
    for name in ("PROJ_DATA", "PROJ_LIB"):
        monkeypatch.delenv(name, raising=False)


def test_heights_are_those_of_the_landscape(facts: Facts, tmp_path: Path) -> None:
    ground = with_terrain(facts, geotiff(tmp_path / "hills.tif", steep)).ground
    for x_m, y_m in ((0.0, 0.0), (-90.0, 3.0), (55.5, -71.2), (100.0, 100.0)):
        assert ground.height_m(x_m, y_m) == pytest.approx(expected(steep, x_m, y_m, facts), abs=0.01)
        rise = (
            (ground.height_m(x_m + 0.5, y_m) - ground.height_m(x_m - 0.5, y_m)),
            (ground.height_m(x_m, y_m + 0.5) - ground.height_m(x_m, y_m - 0.5)),
        )
        assert ground.rise(x_m, y_m) == pytest.approx(rise, abs=1e-3)


def test_roads_follow_steep_ground_within_a_decimetre_everywhere(facts: Facts, tmp_path: Path) -> None:
    built = assembled(with_terrain(facts, geotiff(tmp_path / "hills.tif", steep)))
    assert max(off_ground_m(built)) < 0.1  # a junction 20 m wide in a slope of 8 % takes the slope


def test_roads_follow_gentle_ground_within_a_decimetre_everywhere(facts: Facts, tmp_path: Path) -> None:
    assert max(off_ground_m(assembled(with_terrain(facts, geotiff(tmp_path / "hills.tif", gentle))))) < 0.1


@pytest.mark.unmeasured
def test_waypoints_and_altitudes_of_the_official_client_follow(facts: Facts, tmp_path: Path) -> None:
    built = assembled(with_terrain(facts, geotiff(tmp_path / "hills.tif", gentle)))
    carla_map = carla.Map("Hills", text(built.document).decode())
    found = [waypoint.transform.location for waypoint in carla_map.generate_waypoints(10.0)]
    assert len(found) > 40
    for place in found:
        assert place.z == pytest.approx(expected(gentle, place.x, -place.y, facts), abs=0.1)
        assert carla_map.transform_to_geolocation(place).altitude == pytest.approx(place.z)


def test_info_tells_heights_and_grades(facts: Facts, tmp_path: Path) -> None:
    built = assembled(with_terrain(facts, geotiff(tmp_path / "hills.tif", steep)))
    counts = count(parse(text(built.document)))
    assert 243.0 < counts.lowest_m < counts.highest_m < 257.0
    assert 5.0 < counts.steepest_percent < 15.0


def test_points_of_a_laser_scan_give_the_same_ground(facts: Facts, tmp_path: Path) -> None:
    east, north = middle()
    places = np.arange(-HALF_M, HALF_M, 2.0)
    columns, rows = (axis.reshape(-1) for axis in np.meshgrid(places, places))
    header = laspy.LasHeader(point_format=6, version="1.4")
    header.scales, header.offsets = [0.001] * 3, [east, north, 0.0]
    header.add_crs(CRS(UTM))
    las = laspy.LasData(header)
    las.x = np.concatenate([columns + east, columns + east])
    las.y = np.concatenate([rows + north, rows + north])
    las.z = np.concatenate([gentle(columns, rows), np.full(len(columns), 400.0)])  # treetops are no ground
    las.classification = np.repeat(np.array([2, 5], np.uint8), len(columns))
    las.write(tmp_path / "scan.las")
    ground = with_terrain(facts, tmp_path / "scan.las").ground
    for x_m, y_m in ((0.0, 0.0), (-90.0, 3.0), (55.5, -71.2)):
        assert ground.height_m(x_m, y_m) == pytest.approx(expected(gentle, x_m, y_m, facts), abs=0.05)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda file: geotiff(file, gentle, half_m=60.0), "has no height at latitude "),
        (lambda file: geotiff(file, gentle, crs=None), "has no coordinate reference system; georeference it first"),
        (lambda file: file.write_bytes(b"II*\0no raster"), "cannot be read: "),
        (lambda file: None, "cannot be read: "),
    ],
)
def test_what_is_no_ground_is_refused(
    make: Callable[[Path], object], sentence: str, facts: Facts, tmp_path: Path
) -> None:
    make(tmp_path / "hills.tif")
    with pytest.raises(UserError) as refusal:
        with_terrain(facts, tmp_path / "hills.tif")
    assert sentence in str(refusal.value)
    assert f"--elevation {tmp_path / 'hills.tif'}" in str(refusal.value)


def test_the_command_leaves_no_map_where_the_ground_is_missing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "Linden.xodr"
    ground = geotiff(tmp_path / "hills.tif", gentle)
    assert main(["map", "build", "--elevation", str(ground), "-o", str(out)]) == 2
    assert "take a file that covers them" in capsys.readouterr().err
    assert not out.exists()


def test_a_program_that_has_imported_sumo_reads_the_ground_as_well(tmp_path: Path) -> None:
    ground = geotiff(tmp_path / "hills.tif", gentle)
    program = "import libsumo, sys; from linden.cli import main; sys.exit(main(sys.argv[1:]))"
    words = ["map", "build", "--elevation", str(ground), "-o", str(tmp_path / "Linden.xodr")]
    ran = subprocess.run(
        [sys.executable, "-c", program, *words], capture_output=True, text=True, timeout=120, check=False
    )
    assert "take a file that covers them" in ran.stderr, ran.stderr  # it was read: SUMO's projections were not used
