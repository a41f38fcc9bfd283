"""Write the pictures and the table of docs/how-to/truth.md: `truth_pictures.py RUN --python PYTHON [--work DIR]`.

RUN is a folder of `basu run --record`, PYTHON that of an environment with OpenCV. The run is exported in four kinds of
weather. examples/truth/hog_pedestrians.py looks at the pictures, and `basu truth evaluate` scores it.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
from PIL import Image, ImageDraw

from basu.cli import main as basu
from basu_truth.geometry import EDGES, corners_m, matrix, projected
from basu_truth.truth import SeenObject, Truth, read_truth

ROOT = Path(__file__).resolve().parents[1]
DETECTOR, IMAGES = ROOT / "examples" / "truth" / "hog_pedestrians.py", ROOT / "docs" / "images"
SENSORS = ROOT / "examples" / "truth" / "sensors.json"
WEATHERS = ("ClearNoon", "ClearSunset", "HardRainNoon", "ClearNight")
TRUE, FOUND = (60, 220, 60), (255, 140, 0)


def main() -> int:
    """Export, detect, score, draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=Path)
    parser.add_argument("--python", type=Path, required=True, help="a Python with OpenCV")
    parser.add_argument("--work", type=Path, default=Path("truth-pictures"), help="a folder for the exports")
    parser.add_argument("--every", default="10")
    arguments = parser.parse_args()
    exports = {name: exported(arguments.run, arguments.work / name, name, arguments.every) for name in WEATHERS}
    shown = busiest(read_truth(exports["ClearNoon"]))
    pictures = []
    for name, folder in exports.items():
        detections = folder / "detections.json"
        subprocess.run([str(arguments.python), str(DETECTOR), str(folder), str(detections)], check=True)
        scores = folder / "scores.json"
        basu(["truth", "evaluate", str(folder), "--detections", str(detections), "--json", str(scores)])
        rows = {(row["by"], row["name"]): row for row in json.loads(scores.read_text())["rows"]}
        print(f"{name}: {rows['class', 'pedestrian']}")
        pictures.append(drawn(folder, shown, json.loads(detections.read_text())))
    width, height = pictures[0].size
    sheet = Image.new("RGB", (2 * width, 2 * height))
    for place, picture in enumerate(pictures):
        sheet.paste(picture, ((place % 2) * width, (place // 2) * height))
    sheet.save(IMAGES / "truth-weather.jpg", quality=88)
    boxes(exports["ClearNoon"], shown).save(IMAGES / "truth-boxes.jpg", quality=88)
    return 0


def exported(run: Path, folder: Path, weather: str, every: str) -> Path:
    """Return an export in one kind of weather; one that is there is taken."""
    words = ["truth", "export", str(run), "--format", "coco", "-o", str(folder), "--weather", weather]
    if not folder.exists() and basu([*words, "--sensors", str(SENSORS), "--every", every]):
        sys.exit(1)
    return folder


def busiest(truth: Truth) -> int:
    """Return the frame with most pedestrians that are large in the picture."""
    sizes = dict.fromkeys((frame.number for frame in truth.frames), 0)
    for each in truth.objects:
        if each.category == "pedestrian" and each.rectangle is not None:
            sizes[each.frame] += each.visible > 200
    return max(sizes, key=lambda frame: (sizes[frame], -frame))


def picture_of(folder: Path, frame: int) -> tuple[Image.Image, list[SeenObject], dict[str, object]]:
    """Return the picture of the first camera in a frame, its objects, and its row of annotations.json."""
    truth = read_truth(folder)
    rows = json.loads((folder / "annotations.json").read_text())["images"]
    row = next(each for each in rows if each["frame"] == frame)
    objects = [each for each in truth.objects if (each.frame, each.sensor) == (frame, row["sensor"])]
    return Image.open(folder / row["file_name"]).convert("RGB"), objects, row


def drawn(folder: Path, frame: int, results: list[dict[str, object]]) -> Image.Image:
    """Return the picture with the rectangles of pedestrians and of detections."""
    picture, objects, row = picture_of(folder, frame)
    draw = ImageDraw.Draw(picture)
    for each in objects:
        if each.category == "pedestrian" and each.rectangle is not None:
            rectangle(draw, list(each.rectangle), TRUE)
    for each in results:
        if each["image_id"] == row["id"]:
            rectangle(draw, each["bbox"], FOUND)
    return picture


def boxes(folder: Path, frame: int) -> Image.Image:
    """Return the picture with the boxes of all objects, from red (hidden) to green (whole)."""
    picture, objects, _ = picture_of(folder, frame)
    truth, draw, colours = read_truth(folder), ImageDraw.Draw(picture), mpl.colormaps["RdYlGn"]
    for each in objects:
        corners = corners_m(matrix(each.box_in_sensor), each.size_m)
        if corners[:, 0].min() < 0.5 or each.visible < 20:
            continue
        pixels = projected(corners, truth.sensor(each.sensor))
        colour = tuple(int(255 * value) for value in colours(each.visibility)[:3])
        for a, b in EDGES:
            draw.line([tuple(pixels[a]), tuple(pixels[b])], fill=colour)
        draw.text(
            (float(np.min(pixels[:, 0])), float(np.min(pixels[:, 1])) - 12.0), f"{each.visibility:.0%}", fill=colour
        )
    return picture


def rectangle(draw: ImageDraw.ImageDraw, box: list[float], colour: tuple[int, int, int]) -> None:
    """Draw a rectangle of left, top, width and height."""
    left, top, width, height = box
    draw.rectangle([left, top, left + width, top + height], outline=colour, width=2)


if __name__ == "__main__":
    sys.exit(main())
