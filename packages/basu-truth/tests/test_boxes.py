"""Scores of boxes in space and of tracks: closed forms, nuScenes' results, KITTI's label files, and bad ones."""

import json
import math
from pathlib import Path

import pytest

from basu.cli import main
from basu_truth.truth import Truth
from made_detections import coco_results, kitti_results, nuscenes_results, written


def scores(folder: Path, detections: Path, *words: str) -> dict[tuple[str, str], dict[str, float | None]]:
    """Return the scores of each slice, as the command writes them."""
    target = folder.parent / "scores.json"
    command = ["truth", "evaluate", str(folder), "--detections", str(detections), "--json", str(target), *words]
    assert main(command) == 0
    return {(row["by"], row["name"]): row["scores"] for row in json.loads(target.read_text())["rows"]}


def refusal(folder: Path, detections: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """Return what the command says about detections that it refuses."""
    assert main(["truth", "evaluate", str(folder), "--detections", str(detections)]) == 2
    said = capsys.readouterr().err
    assert "Traceback" not in said
    return said


def test_a_perfect_detector_of_boxes_scores_one(folder: Path, truth: Truth) -> None:
    found = scores(folder, written(folder / "d.json", nuscenes_results(truth)))
    for key, row in found.items():
        assert row["AP 3D"] in {1.0, None}, key
    row = found["all", "all"]
    assert row["ATE m"] == pytest.approx(0.0, abs=1e-3)
    assert (row["MOTA"], row["IDF1"]) == (1.0, 1.0)


@pytest.mark.parametrize(("shift_m", "passed"), [(0.4, 4), (0.7, 3), (1.5, 2), (3.0, 1), (5.0, 0)])
def test_a_detector_that_is_off_passes_the_thresholds_beyond(
    folder: Path, truth: Truth, shift_m: float, passed: int
) -> None:
    found = scores(folder, written(folder / "d.json", nuscenes_results(truth, shift_m=shift_m)))["all", "all"]
    assert found["AP 3D"] == pytest.approx(passed / 4.0)
    assert found["ATE m"] == (pytest.approx(shift_m, abs=1e-3) if shift_m < 2.0 else None)


def test_scale_and_orientation_errors_have_their_closed_forms(folder: Path, truth: Truth) -> None:
    document = nuscenes_results(truth, larger=1.1, turn_deg=20.0)
    found = scores(folder, written(folder / "d.json", document))["all", "all"]
    assert found["ASE"] == pytest.approx(1.0 - 1.0 / 1.1**3, abs=1e-6)
    assert found["AOE rad"] == pytest.approx(math.radians(20.0), abs=1e-6)


def test_a_false_box_before_all_right_ones_lowers_the_precision(folder: Path, truth: Truth) -> None:
    document = nuscenes_results(truth)
    first = next(iter(document["results"].values()))
    first.append({**first[0], "translation": [500.0, 0.0, 0.0], "tracking_score": 1.0, "tracking_id": "99"})
    found = scores(folder, written(folder / "d.json", document))
    positives = 12  # two cars in six frames; precision k / (k + 1) at recall k / 12, straight in between
    curve = [_straight(recall / 100.0, positives) for recall in range(11, 101)]
    assert found["class", "car"]["AP 3D"] == pytest.approx(sum(p - 0.1 for p in curve) / len(curve) / 0.9, abs=1e-9)
    assert found["class", "car"]["MOTA"] == pytest.approx(1.0 - 1.0 / positives)


def _straight(recall: float, positives: int) -> float:
    """Return the precision over the recall, straight between the points of the detections."""
    place = recall * positives
    below = math.floor(place + 1e-9)
    at = [0.0 if k == 0 else k / (k + 1.0) for k in (below, min(below + 1, positives))]
    return at[0] + (place - below) * (at[1] - at[0])


@pytest.mark.parametrize("shift", [0.0, 0.2, 0.5])
def test_tracks_of_rectangles_have_the_iou_as_their_precision(folder: Path, truth: Truth, shift: float) -> None:
    path = written(folder / "d.json", coco_results(truth, shift=shift, tracks=True))
    found, iou = scores(folder, path)["all", "all"], (1.0 - shift) / (1.0 + shift)
    assert found["MOTA"] == (1.0 if iou >= 0.5 else -1.0)  # else each object is missed, and each detection false
    assert found["MOTP"] == (pytest.approx(iou) if iou >= 0.5 else None)


def test_a_switched_identity_costs_one_switch_and_half_of_the_identities(folder: Path, truth: Truth) -> None:
    results = coco_results(truth, tracks=True)
    for result in results:
        if result["track_id"] == 7 and result["image_id"] > 3:
            result["track_id"] = 70
    found = scores(folder, written(folder / "d.json", results))["all", "all"]
    assert found["MOTA"] == pytest.approx(1.0 - 1.0 / 18.0)
    assert found["IDF1"] == pytest.approx(15.0 / 18.0)
    # 12 objects of two tracks are associated fully; those of the third count 3 / (3 + 3) each
    assert found["AssA"] == pytest.approx((12.0 + 6.0 * 0.5) / 18.0)
    assert found["DetA"] == 1.0
    assert found["HOTA"] == pytest.approx(math.sqrt(15.0 / 18.0))


@pytest.mark.parametrize(("shift", "limits"), [(0.0, 19), (0.2, 13), (0.5, 6)])
def test_hota_of_shifted_rectangles_is_the_share_of_limits_up_to_their_iou(
    folder: Path, truth: Truth, shift: float, limits: int
) -> None:
    path = written(folder / "d.json", coco_results(truth, shift=shift, tracks=True))
    assert scores(folder, path)["all", "all"]["HOTA"] == pytest.approx(limits / 19.0)  # 0.05 to 0.95, IoU 1, 2/3, 1/3


@pytest.mark.parametrize(("shift_m", "limits"), [(0.45, 15), (1.33, 6), (2.5, 0)])
def test_hota_of_shifted_boxes_is_the_share_of_limits_up_to_their_similarity(
    folder: Path, truth: Truth, shift_m: float, limits: int
) -> None:
    found = scores(folder, written(folder / "d.json", nuscenes_results(truth, shift_m=shift_m)))
    assert found["class", "pedestrian"]["HOTA"] == pytest.approx(limits / 19.0)  # similarity 1 - shift / 2 m


def test_without_the_package_of_hota_the_other_scores_stay_and_a_sentence_names_it(
    folder: Path, truth: Truth, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("basu_truth.evaluating.track_scores.HOTA_PACKAGE", "trackers_that_is_missing")
    found = scores(folder, written(folder / "d.json", coco_results(truth, tracks=True)))["all", "all"]
    assert found["MOTA"] == 1.0
    assert "HOTA" not in found
    assert "pip install 'basu-truth[hota]'" in capsys.readouterr().out


def test_label_files_of_kitti_are_scored_in_the_picture_and_in_space(folder: Path, truth: Truth) -> None:
    found = scores(folder, kitti_results(folder / "labels", truth))["all", "all"]
    assert (found["AP"], found["AP 3D"]) == (1.0, 1.0)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"tracking_name": "dragon"}, "has the class 'dragon'; there are car, truck"),
        ({"translation": [0.0, float("nan"), 0.0]}, "neither NaN nor infinite"),
        ({"size": [1.0, -2.0, 1.0]}, "sizes must be above 0"),
        ({"rotation": [1.0, 0.0]}, "it must be 4 numbers"),
        ({"tracking_score": None}, "each number must be finite"),
    ],
)
def test_results_of_nuscenes_that_cannot_be_used_are_named(
    folder: Path, truth: Truth, change: dict[str, object], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    document = nuscenes_results(truth)
    sample, entries = next(iter(document["results"].items()))
    entries[1].update(change)
    said = refusal(folder, written(folder / "d.json", document), capsys)
    assert f"sample {sample}, result 2" in said
    assert sentence in said


def test_a_sample_that_is_not_there_is_named(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    said = refusal(folder, written(folder / "d.json", {"meta": {}, "results": {"abc": []}}), capsys)
    assert "the sample abc, which the truth of made does not have; see sample.json" in said


LINE = "Car 0.00 0 0.00 1 2 3 4 1.5 1.8 4.0 0.0 1.0 9.0 0.0 0.5"


@pytest.mark.parametrize(
    ("name", "line", "sentence"),
    [
        ("000099", LINE, "is for a frame that the truth of made does not have; it has 000001 to 000006"),
        ("000001", LINE.replace("Car", "Ship"), "line 1 has the type 'Ship'; it may be Car, Truck"),
        ("000001", LINE.replace("9.0", "nan"), "neither NaN nor infinite"),
        ("000001", LINE.replace("9.0", "far"), "a word that is no number"),
        ("000001", LINE.removesuffix(" 0.5"), "a detection of KITTI has 16, and the last one is its score"),
        ("000001", LINE.replace("1 2 3 4", "3 2 1 4"), "a rectangle or a box without a size"),
    ],
)
def test_label_files_that_cannot_be_used_are_named(
    folder: Path, name: str, line: str, sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "labels").mkdir()
    (folder / "labels" / f"{name}.txt").write_text(f"{line}\n")
    assert sentence in refusal(folder, folder / "labels", capsys)


def test_an_empty_folder_is_no_detections(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "labels").mkdir()
    assert "no label files of KITTI" in refusal(folder, folder / "labels", capsys)
