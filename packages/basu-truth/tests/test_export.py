"""``basu truth export``: what a staged run shows, counted, and runs that cannot be exported."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pycocotools.coco import COCO
from scipy.spatial.transform import Rotation

from basu.cli import main
from basu_carla_log import read_log
from basu_carla_log.layouts import Kind
from basu_truth.formats.nuscenes import token
from basu_truth.truth import SeenObject, read_truth
from made_detections import coco_results, written
from staged_run import AHEAD_M, CAMERA, FRAMES, STEP_S, WALKING_MPS

Exports = Callable[[str], Path]
pytestmark = pytest.mark.slow  # the staged run and its exports


def seen(folder: Path, sensor: str, frame: int) -> dict[str, SeenObject]:
    """Return the actors that a sensor saw: by class, and the cars by their place in the row."""
    found = [o for o in read_truth(folder).objects if (o.sensor, o.frame, o.is_parked) == (sensor, frame, False)]
    cars = sorted((o for o in found if o.category == "car"), key=lambda o: o.distance_m)
    return {o.category: o for o in found if o.category != "car"} | dict(zip(("near", "far"), cars, strict=True))


def test_the_first_car_is_whole_and_hides_most_of_the_second(exported: Exports) -> None:
    front = seen(exported("coco"), "FRONT", 2)
    assert front["near"].visibility == 1.0
    far = front["far"]
    assert far.whole == far.visible + far.hidden_by_actors + far.hidden_by_scenery
    assert far.hidden_by_scenery == 0
    assert 0.1 < far.visibility < 0.9
    assert far.rectangle.width < far.whole_rectangle.width


def test_boxes_stand_where_the_actors_were_put(exported: Exports) -> None:
    front = seen(exported("coco"), "FRONT", 2)
    for name in ("near", "far"):
        ahead_m = front[name].box_in_sensor.x_m + CAMERA["x"]
        assert ahead_m == pytest.approx(AHEAD_M[name], abs=0.3)  # a box's middle is not its actor's origin
    assert front["far"].box_in_sensor.y_m == pytest.approx(front["near"].box_in_sensor.y_m + 0.8, abs=1e-3)


def test_the_area_of_a_car_seen_alone_falls_with_the_square_of_its_distance(exported: Exports) -> None:
    front = seen(exported("coco"), "FRONT", 2)
    near, far = front["near"], front["far"]
    back_m = near.size_m[0] / 2.0  # the side of a car that the camera sees
    ratio = (far.box_in_sensor.x_m - back_m) ** 2 / (near.box_in_sensor.x_m - back_m) ** 2
    assert near.whole / far.whole == pytest.approx(ratio, rel=0.15)


def test_a_walker_that_is_put_to_its_places_has_the_velocity_of_these_places(exported: Exports) -> None:
    places = [np.array(seen(exported("coco"), "FRONT", n)["pedestrian"].box[:2]) for n in range(1, FRAMES + 1)]
    steps = np.diff(places, axis=0) / STEP_S
    assert np.linalg.norm(steps, axis=1) == pytest.approx([WALKING_MPS] * (FRAMES - 1), abs=0.01)


def test_each_frame_shows_the_places_of_the_recording_s_frame(exported: Exports, staged: Path) -> None:
    log = read_log(staged / "recording.log")
    (walker,) = log.ids_of(type_id="walker.*")
    recorded = log.table(Kind.POSITIONS).of(walker).rows["location_cm"] / 100.0
    places = [seen(exported("coco"), "FRONT", n)["pedestrian"].box[:2] for n in range(1, FRAMES + 1)]
    assert np.array(places) == pytest.approx(recorded[:, :2], abs=1e-4)


def test_a_lidar_s_points_are_counted_with_and_without_losses(exported: Exports) -> None:
    far = seen(exported("coco"), "TOP", 2)["far"]
    assert 0 < far.cloud_points < far.visible <= far.whole


def test_the_weather_changes_with_the_frames(exported: Exports) -> None:
    truth = read_truth(exported("coco"))
    assert [frame.weather["precipitation"] for frame in truth.frames] == [0.0, 0.0, 100.0, 100.0]
    dry, wet = (np.asarray(Image.open(exported("coco") / f"images/FRONT/{n:06d}.png"), float) for n in (2, 3))
    assert abs(dry.mean() - wet.mean()) > 5.0


def test_pycocotools_loads_the_export(exported: Exports) -> None:
    coco = COCO(str(exported("coco") / "annotations.json"))
    assert len(coco.imgs) == FRAMES
    for image in coco.imgs.values():
        picture = Image.open(exported("coco") / image["file_name"])
        assert picture.size == (image["width"], image["height"])
    assert {coco.cats[each["category_id"]]["name"] for each in coco.anns.values()} >= {"car", "traffic_cone"}


def test_a_box_of_kitti_projects_onto_its_rectangle_and_has_its_points(exported: Exports) -> None:
    """Read by the rules of KITTI's readme alone."""
    folder = exported("kitti") / "training"
    lines = dict(line.split(":") for line in (folder / "calib" / "000002.txt").read_text().splitlines())
    p2, to_camera = (np.array(lines[name].split(), float).reshape(3, 4) for name in ("P2", "Tr_velo_to_cam"))
    labels = [line.split() for line in (folder / "label_2" / "000002.txt").read_text().splitlines()]
    far = next(words for words in labels if words[0] == "Car" and words[2] == "2")
    left, top, right, bottom, height, width, length, x, y, z, yaw = map(float, far[4:])
    turn = np.array([[np.cos(yaw), 0.0, np.sin(yaw)], [0.0, 1.0, 0.0], [-np.sin(yaw), 0.0, np.cos(yaw)]])
    signs = np.array([(a, b, c) for a in (-0.5, 0.5) for b in (-1.0, 0.0) for c in (-0.5, 0.5)])
    corners = (signs * [length, height, width]) @ turn.T + [x, y, z]
    pixels = np.c_[corners, np.ones(8)] @ p2.T
    columns, rows = pixels[:, 0] / pixels[:, 2], pixels[:, 1] / pixels[:, 2]
    assert [columns.min(), rows.min(), columns.max(), rows.max()] == pytest.approx([left, top, right, bottom], abs=2.5)
    cloud = np.fromfile(folder / "velodyne" / "000002.bin", np.float32).reshape(-1, 4)
    local = (np.c_[cloud[:, :3], np.ones(len(cloud))] @ to_camera.T - [x, y - height / 2.0, z]) @ turn
    inside = int(np.all(np.abs(local) <= np.array([length, height, width]) / 2.0 + 0.05, axis=1).sum())
    assert inside == seen(exported("kitti"), "TOP", 2)["far"].cloud_points > 0


def test_the_tables_of_nuscenes_refer_to_rows_that_are_there(exported: Exports) -> None:
    folder = exported("nuscenes")
    tables = {path.stem: json.loads(path.read_text()) for path in (folder / "v1.0-basu").glob("*.json")}
    scenes = tables.pop("splits")
    assert scenes == {"basu": [tables["scene"][0]["name"]]}
    known = {name: {row["token"] for row in rows} for name, rows in tables.items()}
    for rows in tables.values():
        for row in rows:
            for field, value in row.items():
                table = field.removesuffix("_token")
                if field.endswith("_token") and table in known:
                    assert value in known[table], (field, value)
    for row in tables["sample_data"]:
        assert (folder / row["filename"]).is_file()
    channels = {row["channel"] for row in tables["sensor"]}
    assert channels == {"CAM_FRONT", "LIDAR_TOP"}


def test_the_frames_of_nuscenes_lead_a_box_into_its_picture(exported: Exports) -> None:
    """Follow translation and rotation from the world to the picture, as nuscenes-devkit does."""
    folder = exported("nuscenes")
    tables = {path.stem: json.loads(path.read_text()) for path in (folder / "v1.0-basu").glob("*.json")}
    rows = {row["token"]: row for name in ("ego_pose", "calibrated_sensor") for row in tables[name]}
    picture = next(row for row in tables["sample_data"] if row["filename"].endswith("000002.png"))
    camera = rows[picture["calibrated_sensor_token"]]
    near = seen(folder, "FRONT", 2)["near"]
    wanted = token(read_truth(folder).run, "annotation", near.track, 2)
    place = np.array(next(row for row in tables["sample_annotation"] if row["token"] == wanted)["translation"])
    for pose in (rows[picture["ego_pose_token"]], camera):
        w, x, y, z = pose["rotation"]
        place = Rotation.from_quat([x, y, z, w]).inv().apply(place - pose["translation"])
    column, row, depth = np.array(camera["camera_intrinsic"]) @ place
    box = near.rectangle
    assert (column / depth, row / depth) == pytest.approx((box.left + box.width / 2, box.top + box.height / 2), abs=3.0)
    assert depth == pytest.approx(near.box_in_sensor.x_m, abs=1e-3)


def test_an_export_has_the_same_bytes_again(exported: Exports, staged: Path, tmp_path: Path) -> None:
    again = tmp_path / "again"
    words = ["--format", "coco", "-o", str(again), "--every", "1", "--timeout", "120"]
    assert main(["truth", "export", str(staged), *words]) == 0
    files = sorted(path.relative_to(again) for path in again.rglob("*") if path.is_file())
    assert files == sorted(p.relative_to(exported("coco")) for p in exported("coco").rglob("*") if p.is_file())
    for name in files:
        assert (again / name).read_bytes() == (exported("coco") / name).read_bytes(), name


def test_runs_that_cannot_be_exported_are_named(
    staged: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = tmp_path / "run"
    shutil.copytree(staged, run)

    def refused(*words: str) -> str:
        assert main(["truth", "export", str(run), "--format", "coco", "-o", str(tmp_path / "out"), *words]) == 2
        assert not (tmp_path / "out").exists()
        return capsys.readouterr().err

    assert "--every is 0" in refused("--every", "0")
    assert "there is no weather called 'Hail'" in refused("--weather", "Hail")
    document = json.loads((run / "recording.json").read_text())
    (run / "recording.json").write_text(json.dumps({**document, "vehicle_id": 9999}))
    assert "has no vehicle 9999" in refused()
    (run / "recording.json").write_text(json.dumps({**document, "sensors": []}))
    assert "declared no camera and no lidar; name a sensor file" in refused()
    (run / "recording.json").write_text("{}")
    assert "is not what --record writes" in refused()
    (run / "recording.json").unlink()
    assert "run it again with --record" in refused()
    (run / "recording.log").unlink()
    assert "has no recording.log" in refused()


def test_a_run_is_scored_without_an_export(exported: Exports, staged: Path, tmp_path: Path) -> None:
    detections = written(tmp_path / "d.json", coco_results(read_truth(exported("coco"))))
    target = tmp_path / "scores.json"
    words = ["--detections", str(detections), "--every", "1", "--json", str(target), "--timeout", "120"]
    assert main(["truth", "evaluate", str(staged), *words]) == 0
    assert json.loads(target.read_text())["rows"][0]["scores"]["AP"] == 1.0


def test_a_run_is_exported_in_another_weather(staged: Path, tmp_path: Path) -> None:
    words = [
        "--format",
        "coco",
        "-o",
        str(tmp_path / "night"),
        "--every",
        "4",
        "--weather",
        "ClearNight",
        "--timeout",
        "120",
    ]
    assert main(["truth", "export", str(staged), *words]) == 0
    (frame,) = read_truth(tmp_path / "night").frames
    assert frame.weather["sun_altitude_angle"] < 0.0


def test_a_folder_that_is_there_stays(staged: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    kept = tmp_path / "kept.txt"
    kept.write_text("mine")
    assert main(["truth", "export", str(staged), "--format", "coco", "-o", str(tmp_path)]) == 2
    assert "is there already; name another folder" in capsys.readouterr().err
    assert kept.read_text() == "mine"
