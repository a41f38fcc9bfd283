"""Claims about path.png: it shows both paths, and the same drive gives the same picture."""

from pathlib import Path

import numpy as np
from PIL import Image

from basu.output.report.path_picture import draw
from fakes.drives import at, driven, hit

STREET = np.array([[-20.0, 0.0], [220.0, 0.0]])


def pixels(path: Path) -> np.ndarray:
    return np.asarray(Image.open(path).convert("RGB")).astype(int)


def near(image: np.ndarray, colour: tuple[int, int, int]) -> int:
    """How many pixels have about this colour."""
    return int((np.abs(image - colour).max(axis=2) < 30).sum())


def test_plan_drive_and_infraction_are_in_the_picture(tmp_path: Path) -> None:
    draw(tmp_path / "path.png", driven(at(10.0, 15.0), collisions=[hit(40)]), [STREET], "a drive")
    image = pixels(tmp_path / "path.png")
    assert near(image, (0xE6, 0x55, 0x0D)) > 200  # driven
    assert near(image, (0xA5, 0x0F, 0x15)) > 50  # the infraction's cross
    assert near(image, (0xA3, 0xC5, 0xE0)) > 100  # planned, pale, where the drive ended before it


def test_the_same_drive_gives_the_same_picture(tmp_path: Path) -> None:
    for name in ("first.png", "second.png"):
        draw(tmp_path / name, driven(at(10.0, 15.0)), [STREET], "a drive")
    assert (tmp_path / "first.png").read_bytes() == (tmp_path / "second.png").read_bytes()
