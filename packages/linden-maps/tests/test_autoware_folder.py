"""The folder for Autoware: complete, described, and in one frame."""

import hashlib
import json

import numpy as np
import pytest

from linden.cli import main
from linden.errors import UserError
from linden.maps.cache import MapCache
from linden.protocol.values.enums import SemanticTag
from linden.scenery.map_mesh_cache import standing_of
from linden.sensors.casting.choose import caster_of
from linden.simulation.surroundings import scenery_of
from linden_maps.autoware_folder import UNIVERSE, point_cloud_metadata
from linden_maps.cli.map_source import world_map_of
from linden_maps.lanelet2.model import bounds_of
from linden_maps.lanelet2.osm import osm_bytes, read_osm
from linden_maps.pointcloud.cloud import Cloud, in_map
from linden_maps.pointcloud.drive import Lidar, SensorPlace, drive
from linden_maps.pointcloud.pcd_writing import PcdWriter
from vector_map_town import two_roads

KERB_M = 0.05
_TURN = Lidar(channels=64, upper_fov_deg=-12.0, lower_fov_deg=-48.0, range_m=25.0, columns=1440)


@pytest.fixture
def cloud(tmp_path):
    with PcdWriter(tmp_path / "own.pcd", "a cloud") as writer:
        writer.write(Cloud(np.array([[-3.0, 5.0, 100.0], [61.0, -7.0, 101.0]]), None))
    return tmp_path / "own.pcd"


def test_the_folder_is_complete_and_its_manifest_names_every_file(tmp_path, cloud, capsys):
    (tmp_path / "small.xodr").write_text(two_roads())
    target = tmp_path / "town"
    words = ["map", "package", str(tmp_path / "small.xodr"), "--for", "autoware", "-o", str(target)]
    assert main([*words, "--pointcloud", str(cloud)]) == 0
    steps = [line for line in capsys.readouterr().err.splitlines() if line.startswith("step ")]
    assert [line.partition(":")[0] for line in steps] == [f"step {number} of 4" for number in range(1, 5)]
    assert {path.name for path in target.iterdir()} == {
        "lanelet2_map.osm",
        "map_projector_info.yaml",
        "pointcloud_map.pcd",
        "pointcloud_map_metadata.yaml",
        "aisan",
        "manifest.json",
    }
    assert all(UNIVERSE.is_ours(path.name) for path in target.iterdir())
    told = json.loads((target / "manifest.json").read_text())
    assert told["source"]["sha256"] == hashlib.sha256(two_roads().encode()).hexdigest()
    assert told["origin"] == {"latitude_deg": 40.0, "longitude_deg": -83.0}
    files = {path.relative_to(target).as_posix() for path in target.rglob("*") if path.is_file()}
    assert set(told["files"]) == files - {"manifest.json"}
    for name, facts in told["files"].items():
        assert facts["sha256"] == hashlib.sha256((target / name).read_bytes()).hexdigest()
    assert main([*words, "--pointcloud", str(cloud)]) == 0  # over its own older one
    assert json.loads((target / "manifest.json").read_text()) == told


def test_the_folder_for_carla_autoware_has_the_places_that_its_launch_files_read(tmp_path, cloud, capsys):
    (tmp_path / "small.xodr").write_text(two_roads())
    target = tmp_path / "contents"
    words = ["map", "package", str(tmp_path / "small.xodr"), "--for", "autoware", "--ros1", "-o", str(target)]
    assert main([*words, "--pointcloud", str(cloud)]) == 0
    files = {path.relative_to(target).as_posix() for path in target.rglob("*") if path.is_file()}
    vectors = "maps/vector_maps/asian/small"
    assert {"maps/point_cloud_maps/small.pcd", "maps/vector_maps/lanelet2/small.osm", "manifest.json"} <= files
    wanted = {"dtlane", "lane", "line", "node", "point"}
    assert {f"{vectors}/{name}.csv" for name in wanted} <= files
    (tmp_path / "other.xodr").write_text(two_roads())
    words[2] = str(tmp_path / "other.xodr")
    assert main([*words, "--pointcloud", str(cloud)]) == 2
    assert "which is no part of this town; name a folder of its own" in capsys.readouterr().err
    assert files == {path.relative_to(target).as_posix() for path in target.rglob("*") if path.is_file()}


def test_a_folder_with_other_files_is_left_alone(tmp_path, cloud, capsys):
    (tmp_path / "small.xodr").write_text(two_roads())
    target = tmp_path / "town"
    target.mkdir()
    (target / "thesis.txt").write_text("mine")
    words = ["map", "package", str(tmp_path / "small.xodr"), "--for", "autoware", "-o", str(target)]
    assert main([*words, "--pointcloud", str(cloud)]) != 0
    assert "thesis.txt, which is no part of the map" in capsys.readouterr().err
    assert [path.name for path in target.iterdir()] == ["thesis.txt"]
    assert not list(tmp_path.glob(".*"))


def test_metadata_hold_the_whole_cloud(cloud):
    text = point_cloud_metadata(cloud).decode()
    assert text == "x_resolution: 100.0\ny_resolution: 40.0\npointcloud_map.pcd: [-20.0, -20.0]\n"


def test_an_empty_cloud_is_refused(tmp_path):
    with PcdWriter(tmp_path / "none.pcd", "nothing"):
        pass
    with pytest.raises(UserError, match="has no points"):
        point_cloud_metadata(tmp_path / "none.pcd")


@pytest.mark.unmeasured
def test_lidar_rays_meet_the_kerbs_where_the_lanelet_bounds_are(linden, linden_lanelets):
    """Points on the road lie on the road's side of the bound, points on the pavement on the other, within 5 cm."""
    read = read_osm(osm_bytes(linden_lanelets.lanelet_map), "linden.osm", linden.geo_reference)
    world_map = world_map_of("Linden")
    standing = standing_of(world_map, scenery_of(world_map).scene, MapCache.of_user())
    caster = caster_of(standing, [])
    checked = {SemanticTag.ROADS: 0, SemanticTag.SIDEWALKS: 0}
    for side, line in _kerbs(read)[::40]:
        at = line.mean(axis=0)
        along = (line[1] - line[0])[:2] / np.linalg.norm((line[1] - line[0])[:2])
        inward = np.array([-along[1], along[0]]) * side
        (scan,) = drive([SensorPlace(*(at[:2] + 4.0 * inward), at[2] + 2.4, 0.0)], _TURN, caster, standing)
        cloud = in_map(scan)
        away = cloud.points_m[:, :2] - at[:2]
        aside, ahead = away @ inward, away @ along
        slope = (line[1, 2] - line[0, 2]) / np.linalg.norm((line[1] - line[0])[:2])
        rise = cloud.points_m[:, 2] - at[2] - ahead * slope
        near = (np.abs(ahead) < 3.0) & (np.abs(aside) < 0.6) & (np.abs(rise) < 0.3)
        road = near & (np.abs(rise) < 0.05)
        kerb = near & (rise > 0.12) & (rise < 0.2)
        assert not road.any() or aside[road].min() > -KERB_M
        assert not kerb.any() or aside[kerb].max() < KERB_M
        checked[SemanticTag.ROADS] += int(road.sum())
        checked[SemanticTag.SIDEWALKS] += int(kerb.sum())
    assert min(checked.values()) > 500


def _kerbs(lanelet_map):
    """Return straight kerbs of more than 20 m along road lanelets; 1 where the road lies to the left."""
    found = []
    for _, lanelet in lanelet_map.lanelets("road"):
        way = lanelet_map.ways[lanelet.refs("right")[0]]
        right = np.array([lanelet_map.nodes[node][:3] for node in bounds_of(lanelet_map, lanelet).right])
        if way.tags.get("subtype") == "curbstone" and len(right) == 2 and np.linalg.norm(right[1] - right[0]) > 20.0:
            found.append((1.0, right))
    return found


def _package(tmp_path, cloud, *words):
    (tmp_path / "small.xodr").write_text(two_roads())
    made = ["map", "package", str(tmp_path / "small.xodr"), "-o", str(tmp_path / "town"), *words]
    return main([*made, "--pointcloud", str(cloud)] if cloud is not None else made)


def test_the_folder_along_a_route_has_its_lanes_and_the_whole_lanelet_map(tmp_path, cloud):
    route = tmp_path / "route.xml"
    route.write_text('<routes><route><position x="5" y="1.75"/><position x="30" y="1.75"/></route></routes>')
    words = ("--for", "autoware", "--ros1", "--along", str(route), "--within", "0.5")
    assert _package(tmp_path, cloud, *words[:3]) == 0
    vectors = tmp_path / "town" / "maps" / "vector_maps"
    whole = {path.name: path.read_bytes() for path in vectors.rglob("*") if path.is_file()}
    assert _package(tmp_path, cloud, *words[:-1], "0.5") == 2  # nearer than the sides of the lane: it makes no lane
    assert {path.name: path.read_bytes() for path in vectors.rglob("*") if path.is_file()} == whole
    assert _package(tmp_path, cloud, *words[:-1], "4") == 0
    part = {path.name: path.read_bytes() for path in vectors.rglob("*") if path.is_file()}
    assert part["small.osm"] == whole["small.osm"]
    assert 1 < len(part["lane.csv"].splitlines()) <= len(whole["lane.csv"].splitlines())


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--for", "carla", "--along", "route.xml"), "--along are for --for autoware; leave them out"),
        (("--for", "autoware", "--along", "none.xml"), "cannot read the route of none.xml"),
    ],
)
def test_a_route_that_cannot_be_used_is_refused_before_the_work(tmp_path, capsys, words, sentence):
    assert _package(tmp_path, None, *words) == 2
    told = capsys.readouterr().err
    assert sentence in told
    assert "step" not in told
    assert not (tmp_path / "town").exists()
