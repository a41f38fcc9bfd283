"""Let nuscenes-devkit load an export and score a perfect and a shifted detector; compare with BASU's own scores.

usage: nuscenes_judge.py --python PYTHON EXPORT [--shift M]

EXPORT is what `basu truth export RUN --format nuscenes` wrote, with a lidar. PYTHON is that of another environment:

    python -m venv devkit && devkit/bin/pip install nuscenes-devkit

The devkit needs another numpy than BASU. It leaves out objects without a point in a cloud, so the detectors find the
others alone. The exit status is 1 where the two programs disagree by more than 1e-6.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from basu_truth.truth import Truth

AGREED = 1e-6
FAR_M = 1000.0  # the devkit's ranges of classes, which are 30 to 50 m else


def main() -> int:
    """Compare, or score inside of the devkit's environment."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("export", type=Path)
    parser.add_argument("--python", type=Path, help="the devkit's Python")
    parser.add_argument("--shift", type=float, default=1.5, metavar="M", help="of the second detector, to the east")
    parser.add_argument("--results", type=Path, help=argparse.SUPPRESS)  # of the process inside of the environment
    arguments = parser.parse_args()
    if arguments.results is not None:
        print(json.dumps(devkit_scores(arguments.export, arguments.results)))
        return 0
    if arguments.python is None:
        parser.error("--python is missing: name the Python of an environment that has nuscenes-devkit")
    agreed = [compared(arguments.export, arguments.python, shift_m) for shift_m in (0.0, arguments.shift)]
    return 0 if all(agreed) else 1


def devkit_scores(export: Path, results: Path) -> dict[str, dict[str, float]]:
    """Return AP and mean translation error of each class, as the devkit computes them."""
    from nuscenes import NuScenes  # noqa: PLC0415 - in the devkit's environment only
    from nuscenes.eval.common.config import config_factory  # noqa: PLC0415
    from nuscenes.eval.detection.evaluate import DetectionEval  # noqa: PLC0415

    data = NuScenes("v1.0-basu", str(export), verbose=False)
    config = config_factory("detection_cvpr_2019")
    config.class_range = dict.fromkeys(config.class_range, FAR_M)
    with tempfile.TemporaryDirectory() as folder:
        judge = DetectionEval(data, config, str(results), "basu", folder, verbose=False)
        metrics, _ = judge.evaluate()
    errors = {name: each["trans_err"] for name, each in metrics.serialize()["label_tp_errors"].items()}
    return {name: {"AP": ap, "ATE": errors[name]} for name, ap in metrics.mean_dist_aps.items()}


def compared(export: Path, python: Path, shift_m: float) -> bool:
    """Print both programs' scores of a detector that is off by so much; return whether they agree."""
    from basu_truth.evaluating.box_scores import box_score  # noqa: PLC0415 - not in the devkit's environment
    from basu_truth.evaluating.detections import read_detections  # noqa: PLC0415
    from basu_truth.evaluating.scoring import one_a_frame  # noqa: PLC0415
    from basu_truth.evaluating.slices import slices  # noqa: PLC0415
    from basu_truth.truth import read_truth  # noqa: PLC0415

    truth = read_truth(export)
    hit = {(each.frame, each.track) for each in truth.objects if each.cloud_points}
    objects = [each for each in one_a_frame(truth.objects, None) if (each.frame, each.track) in hit]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "results.json"
        path.write_text(json.dumps(results_of(export, truth, hit, shift_m)))
        found = read_detections(path, truth).boxes or ()
        command = [str(python), str(Path(__file__).resolve()), str(export), "--results", str(path)]
        said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    theirs = json.loads(said.splitlines()[-1])
    agreed = True
    for part in slices(truth):
        if part.by != "class" or part.name not in theirs:
            continue
        ours = box_score(objects, found, part, lambda _: True)
        if ours.ap is None:
            continue
        print(f"{shift_m:g} m, {part.name}: AP {ours.ap:.6f} of BASU, {theirs[part.name]['AP']:.6f} of nuscenes-devkit")
        agreed &= abs(ours.ap - theirs[part.name]["AP"]) <= AGREED
    return agreed


def results_of(export: Path, truth: "Truth", hit: set[tuple[int, int]], shift_m: float) -> dict[str, Any]:
    """Return results of the detection task: the annotations of the export that a cloud has, moved to the east."""
    from basu_truth.formats.nuscenes import sample_tokens  # noqa: PLC0415 - not in the devkit's environment
    from basu_truth.formats.nuscenes import token as token_of  # noqa: PLC0415

    category = {token_of(truth.run, "instance", each.track): each.category for each in truth.objects}
    wanted = {token_of(truth.run, "annotation", track, frame) for frame, track in hit}
    results: dict[str, list[dict[str, Any]]] = {sample: [] for sample in sample_tokens(truth)}
    for row in json.loads((export / "v1.0-basu" / "sample_annotation.json").read_text()):
        if row["token"] not in wanted or category[row["instance_token"]] == "animal":
            continue
        x, y, z = row["translation"]
        results[row["sample_token"]].append(
            {
                "sample_token": row["sample_token"],
                "translation": [x + shift_m, y, z],
                "size": row["size"],
                "rotation": row["rotation"],
                "velocity": [0.0, 0.0],
                "detection_name": category[row["instance_token"]],
                "detection_score": 0.9,
                "attribute_name": "",
            }
        )
    return {
        "meta": dict.fromkeys(("use_camera", "use_lidar", "use_radar", "use_map", "use_external"), False),
        "results": results,
    }


if __name__ == "__main__":
    sys.exit(main())
