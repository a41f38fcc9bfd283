"""Puts pictures of outside programs' windows on one sheet: ``sheet.py OUT PROGRAMS SHEET.jpg``, after ``run.py``."""

import argparse
from pathlib import Path

from folders import Folders
from PIL import Image, ImageDraw, ImageFont, ImageOps

CELL_PX = (480, 300)
COLUMNS = 3
CAPTION_PX = 22
WINDOWS = (
    ("manual_control.py: behind the car", "Linden_manual_control.py_--sync", "*-p.jpg"),
    ("manual_control.py: semantic", "Linden_manual_control.py_--sync", "*-6.jpg"),
    ("manual_control.py: instances", "Linden_manual_control.py_--sync", "*-8.jpg"),
    ("manual_control.py: events", "Linden_manual_control.py_--sync", "*-ctrl-2.jpg"),
    ("manual_control.py: optical flow", "Linden_manual_control.py_--sync", "*-ctrl-4.jpg"),
    ("manual_control.py: normals", "Linden_manual_control.py_--sync", "*-ctrl-5.jpg"),
    ("visualize_multiple_sensors.py", "Linden_visualize_multiple_sensors.py", "0?.jpg"),
    ("client_bounding_boxes.py", "Linden_client_bounding_boxes.py", "0?.jpg"),
    ("bounding_boxes.py (Town01)", "Town01_bounding_boxes.py", "0?.jpg"),
    ("synchronous_mode.py", "Linden_synchronous_mode.py", "0?.jpg"),
    ("draw_skeleton.py (Town01)", "Town01_draw_skeleton.py", "0?.jpg"),
)
"""Caption, row, and which of its pictures: the last that fits."""


def main() -> None:
    """Make the sheet of those windows that were kept, and of a picture that lidar_to_camera.py wrote."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("programs", type=Path)
    parser.add_argument("sheet", type=Path)
    args = parser.parse_args()
    found = [
        (caption, kept[-1])
        for caption, row, pattern in WINDOWS
        if (kept := sorted((args.out / f"{row}.pictures").glob(pattern)))
    ]
    written = Folders(args.programs, *[Path()] * 4).of("examples") / "_out"
    found += [("lidar_to_camera.py", path) for path in sorted(written.glob("0000????.png"))[2:3]]
    rows = -(-len(found) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * CELL_PX[0], rows * (CELL_PX[1] + CAPTION_PX)), (16, 16, 20))
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(14)
    for number, (caption, path) in enumerate(found):
        x, y = number % COLUMNS * CELL_PX[0], number // COLUMNS * (CELL_PX[1] + CAPTION_PX)
        sheet.paste(ImageOps.fit(Image.open(path).convert("RGB"), CELL_PX), (x, y + CAPTION_PX))
        draw.text((x + 6, y + 3), caption, (230, 230, 230), font)
    sheet.save(args.sheet, quality=86)


if __name__ == "__main__":
    main()
