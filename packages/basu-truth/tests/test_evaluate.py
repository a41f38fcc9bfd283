"""``basu truth evaluate``: a perfect and a shifted detector, slices, and input that cannot be used."""

import contextlib
import io
import json
from pathlib import Path

import pytest
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval

from basu.cli import main
from basu_truth.evaluating.slices import weather_name
from basu_truth.formats.coco import coco_document
from basu_truth.truth import Truth, read_truth
from made_detections import coco_results, written


def scores(folder: Path, detections: Path, *words: str) -> dict[tuple[str, str], dict[str, float | None]]:
    """Return the scores of each slice, as the command writes them."""
    target = folder.parent / "scores.json"
    command = ["truth", "evaluate", str(folder), "--detections", str(detections), "--json", str(target), *words]
    assert main(command) == 0
    return {(row["by"], row["name"]): row["scores"] for row in json.loads(target.read_text())["rows"]}


def test_a_truth_is_read_as_it_was_written(folder: Path, truth: Truth) -> None:
    assert read_truth(folder) == truth


def test_a_perfect_detector_scores_one_in_every_slice(folder: Path, truth: Truth) -> None:
    found = scores(folder, written(folder / "d.json", coco_results(truth)))
    known = {key: row["AP"] for key, row in found.items() if row["AP"] is not None}
    assert set(known.values()) == {1.0}
    assert {name for by, name in known if by == "distance"} == {"0-20 m", "20-40 m", "80 m and more"}
    assert {name for by, name in known if by == "visibility"} == {"40-60 %", "80-100 %"}
    assert {name for by, name in known if by == "weather"} == {"day, clear", "night, rain"}


@pytest.mark.parametrize("shift", [0.1, 0.2, 0.3, 0.5])
def test_a_shifted_detector_scores_the_share_of_thresholds_below_its_iou(
    folder: Path, truth: Truth, shift: float
) -> None:
    iou = (1.0 - shift) / (1.0 + shift)
    passed = sum(iou >= 0.5 + 0.05 * step for step in range(10))
    found = scores(folder, written(folder / "d.json", coco_results(truth, shift=shift)))
    assert found["all", "all"]["AP"] == pytest.approx(passed / 10.0)


def test_a_slice_leaves_out_what_is_not_in_it(folder: Path, truth: Truth) -> None:
    near = {each.track for each in truth.objects if each.distance_m < 20.0}
    ids = [each["track_id"] in near for each in coco_document(truth)["annotations"]]
    chosen = [result for result, is_near in zip(coco_results(truth), ids, strict=True) if is_near]
    found = scores(folder, written(folder / "d.json", chosen))
    assert found["distance", "0-20 m"]["AP"] == 1.0
    assert found["distance", "20-40 m"]["AP"] == 0.0
    assert found["class", "pedestrian"]["AP"] == 0.0
    assert found["class", "car"]["AP"] == pytest.approx(51 / 101)  # recalls 0 to 0.50, of 101


def test_small_objects_count_neither_way(folder: Path, truth: Truth) -> None:
    found = scores(folder, written(folder / "d.json", coco_results(truth)), "--least", "101")
    assert all(row["AP"] is None for row in found.values())


def test_pycocotools_itself_gives_the_same_value(folder: Path, truth: Truth) -> None:
    (folder / "annotations.json").write_text(json.dumps(coco_document(truth)))
    results = written(folder / "d.json", coco_results(truth, shift=0.2))
    with contextlib.redirect_stdout(io.StringIO()):
        coco = COCO(str(folder / "annotations.json"))
        judge = COCOeval(coco, coco.loadRes(str(results)), "bbox")
        judge.evaluate()
        judge.accumulate()
        judge.summarize()
    assert scores(folder, results)["all", "all"]["AP"] == pytest.approx(judge.stats[0])


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"image_id": 999}, "image_id 999, which the truth does not have; it has 1 to 6"),
        ({"image_id": "one"}, "image_id 'one', which the truth does not have"),
        ({"category_id": 77}, "category_id 77; it may be 1 (car)"),
        ({"bbox": [0.0, 0.0, float("nan"), 4.0]}, "each number must be finite, neither NaN nor infinite"),
        ({"bbox": [0.0, 0.0, 4.0]}, "it must be 4 numbers"),
        ({"bbox": [0.0, 0.0, 0.0, 4.0]}, "a bbox without an area"),
        ({"score": None}, "each number must be finite"),
    ],
)
def test_results_that_cannot_be_used_are_named(
    folder: Path, truth: Truth, change: dict[str, object], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    results = coco_results(truth)
    results[2].update(change)
    path = written(folder / "d.json", results)
    assert main(["truth", "evaluate", str(folder), "--detections", str(path)]) == 2
    said = capsys.readouterr().err
    assert "result 3" in said
    assert sentence in said
    assert "Traceback" not in said


@pytest.mark.parametrize(
    ("text", "sentence"),
    [("{}", "no known form of detections"), ("[1]", "is no JSON object"), ("[{}]", "has no image_id"), ("{", "JSON")],
)
def test_a_file_in_another_form_is_refused(
    folder: Path, text: str, sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = folder / "d.json"
    path.write_text(text)
    assert main(["truth", "evaluate", str(folder), "--detections", str(path)]) == 2
    assert sentence in capsys.readouterr().err


def test_what_is_not_there_is_named(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["truth", "evaluate", str(folder), "--detections", str(tmp_path / "none.json")]) == 2
    assert "is not there; name the file" in capsys.readouterr().err
    path = written(tmp_path / "d.json", [])
    assert main(["truth", "evaluate", str(tmp_path / "no run"), "--detections", str(path)]) == 2
    assert "is not a folder; name a run's folder" in capsys.readouterr().err
    assert main(["truth", "evaluate", str(folder), "--detections", str(path), "--sensor", "REAR"]) == 2
    assert "has no sensor 'REAR'; it has FRONT, TOP" in capsys.readouterr().err


def test_weather_has_a_name_by_light_and_air() -> None:
    assert weather_name({}) == "the map's own"
    assert weather_name({"sun_altitude_angle": -3.0, "fog_density": 60.0}) == "dusk, fog"
    assert weather_name({"sun_altitude_angle": -6.0, "precipitation": 20.0, "fog_density": 20.0}) == (
        "night, rain and fog"
    )
