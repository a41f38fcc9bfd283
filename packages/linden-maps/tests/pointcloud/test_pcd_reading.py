"""Claims about reading PCD files."""

from pathlib import Path

import numpy as np
import pytest

from fakes.pcd_files import pcd
from linden.errors import UserError
from linden_maps.pointcloud.pcd_reading import clouds_of, header_of

FORMS = ["ascii", "binary", "binary_compressed"]
XYZ = {
    "x": np.array([1.5, -2.25, 1e4], np.float32),
    "y": np.array([0.1, 0.2, -3000.125], np.float32),
    "z": np.array([0.0, 250.5, -1.0], np.float32),
}


def read(file: Path, stretch: int = 2) -> tuple[np.ndarray, np.ndarray | None]:
    clouds = list(clouds_of(file, stretch))
    labels = [cloud.label for cloud in clouds if cloud.label is not None]
    return np.concatenate([cloud.points_m for cloud in clouds]), np.concatenate(labels) if labels else None


@pytest.mark.parametrize("data", FORMS)
@pytest.mark.parametrize("padding", [False, True])
def test_points_come_back_from_every_form(data: str, *, padding: bool, tmp_path: Path) -> None:
    intensity = {"intensity": np.array([0.5, np.nan, 1.0], np.float32)}
    points, label = read(pcd(tmp_path / "a.pcd", {**XYZ, **intensity}, data, padding=padding))
    np.testing.assert_array_equal(points, np.stack([XYZ[axis] for axis in "xyz"], axis=1))
    assert label is None


@pytest.mark.parametrize("data", FORMS)
def test_labels_come_with_them(data: str, tmp_path: Path) -> None:
    _, label = read(pcd(tmp_path / "a.pcd", {**XYZ, "label": np.array([1, 0, 4_000_000_000], np.uint32)}, data))
    assert label is not None
    assert label.tolist() == [1, 0, 4_000_000_000]


@pytest.mark.parametrize("data", FORMS)
def test_any_number_may_be_a_coordinate(data: str, tmp_path: Path) -> None:
    columns = {"x": np.array([-3, 7], np.int16), "y": np.array([1.25, 1e-9]), "z": np.array([0, 255], np.uint8)}
    points, _ = read(pcd(tmp_path / "a.pcd", columns, data))
    np.testing.assert_array_equal(points, [[-3.0, 1.25, 0.0], [7.0, 1e-9, 255.0]])


@pytest.mark.parametrize("data", FORMS)
def test_a_cut_file_gets_a_sentence(data: str, tmp_path: Path) -> None:
    file = pcd(tmp_path / "a.pcd", XYZ, data)
    file.write_bytes(file.read_bytes()[:-13])
    with pytest.raises(UserError, match=r"a\.pcd is broken"):
        read(file)


@pytest.mark.parametrize(
    ("before", "after", "told"),
    [
        ("FIELDS x y z", "FIELDS x y w", "has no field z; it has x y w"),
        ("DATA ascii", "DATA zipped", "has DATA zipped; known are ascii"),
        ("DATA ascii", "DATUM ascii", "there is no line DATA"),
        ("TYPE F F F", "TYPE F F Q", "field z: TYPE Q, SIZE 4"),
        ("SIZE 4 4 4", "SIZE 4 4", "head is wrong about"),
        ("WIDTH 3", "WIDTH 4", "WIDTH 4 x HEIGHT 1 are not POINTS 3"),
        ("POINTS 3", "POINTS three", "head is wrong about"),
    ],
)
def test_an_impossible_head_gets_a_sentence(before: str, after: str, told: str, tmp_path: Path) -> None:
    file = pcd(tmp_path / "a.pcd", XYZ, "ascii")
    text = file.read_text()
    assert before in text
    file.write_text(text.replace(before, after))
    with pytest.raises(UserError, match=told):
        header_of(file)


def test_words_that_are_no_numbers_get_a_sentence(tmp_path: Path) -> None:
    file = pcd(tmp_path / "a.pcd", XYZ, "ascii")
    file.write_text(file.read_text().replace("250.5", "high"))
    with pytest.raises(UserError, match="broken after point 0: could not convert"):
        read(file)


def test_a_missing_file_gets_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"cannot read .*none\.pcd: No such file"):
        header_of(tmp_path / "none.pcd")
