"""``basu record dataset``: the same bytes, also after a break; readers of the shards; input that is refused."""

import json
import tarfile
from pathlib import Path

import numpy as np
import pytest
import webdataset

from basu.cli import main
from basu.errors import UserError
from basu_truth.dataset.loading import samples
from basu_truth.truth import read_truth
from staged_run import CAMERA, LIDAR

CAMPAIGN = """name = "crossings"
agents = ["basic"]
[[drives]]
cases = ["pedestrian_crossing_1"]
sweep = 2
vary = ["ahead"]
"""
EVERY, PER_SHARD = 200, 2


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a campaign and a small rig."""
    place = tmp_path_factory.mktemp("campaign")
    (place / "campaign.toml").write_text(CAMPAIGN)
    (place / "rig.json").write_text(json.dumps({"sensors": [{**CAMERA, "width": 160, "height": 100}, LIDAR]}))
    return place


def record(files: Path, folder: Path, *options: object) -> int:
    """Call the command."""
    words = ["record", "dataset", files / "campaign.toml", "-o", folder, "--sensors", files / "rig.json"]
    return main([str(word) for word in (*words, "--every", EVERY, "--per-shard", PER_SHARD, *options)])


@pytest.fixture(scope="module")
def dataset(files: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a data set that was recorded at once."""
    folder = tmp_path_factory.mktemp("sets") / "whole"
    assert record(files, folder) == 0
    return folder


def contents(folder: Path) -> dict[str, bytes]:
    """Return the files of a data set but for its lock."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != ".lock"
    }


@pytest.mark.slow
def test_a_data_set_that_was_broken_off_has_the_bytes_of_one_that_was_not(
    files: Path, dataset: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "broken"
    assert record(files, folder, "--drives", 1) == 0
    left = folder / "scratch" / "drives-killed"
    left.mkdir(parents=True)  # as a command that was killed leaves it
    assert record(files, folder, "--resume") == 0
    assert contents(folder) == contents(dataset)


@pytest.mark.slow
def test_webdataset_streams_the_samples_of_the_drives(dataset: Path) -> None:
    shards = [str(dataset / line) for line in (dataset / "shards.txt").read_text().splitlines()]
    theirs = list(webdataset.WebDataset(shards, shardshuffle=False).decode("rgb8"))
    document = json.loads((dataset / "dataset.json").read_text())
    assert len(document["drives"]) == 2
    assert len(shards) == sum(-(-drive["samples"] // PER_SHARD) for drive in document["drives"])
    ours = list(samples(dataset))
    assert len(theirs) == len(ours) == document["samples"] > PER_SHARD
    for sample, own in zip(theirs, ours, strict=True):
        assert sample["__key__"].endswith(own.key)
        assert np.array_equal(sample["front.png"], own.pictures["FRONT"])
        assert np.array_equal(sample["top.npy"], own.clouds["TOP"])
        assert sample["json"]["frame"]["number"] == own.frame.number
        assert own.pictures["FRONT"].shape == (100, 160, 3)
        assert len(own.clouds["TOP"]) > 1000


@pytest.mark.slow
def test_the_samples_have_the_objects_of_the_truth(dataset: Path) -> None:
    found = list(samples(dataset))
    for drive in sorted((dataset / "drives").iterdir()):
        truth = read_truth(drive)
        number = drive.name.partition("-")[0]
        own = [sample for sample in found if sample.key.startswith(f"{number}-")]
        assert tuple(sample.frame for sample in own) == truth.frames
        assert tuple(each for sample in own for each in sample.objects) == truth.objects
        assert any(each.category == "pedestrian" for each in truth.objects)


@pytest.mark.slow
def test_a_damaged_shard_is_named(dataset: Path, tmp_path: Path) -> None:
    line = (dataset / "shards.txt").read_text().splitlines()[0]
    shard = tmp_path / line
    shard.parent.mkdir(parents=True)
    shard.write_bytes((dataset / line).read_bytes()[:5000])
    (tmp_path / "shards.txt").write_text(f"{line}\n")
    with pytest.raises(UserError, match=r"0000\.tar cannot be read: .*; record the data set again"):
        list(samples(tmp_path))


def test_a_folder_that_is_no_data_set_is_named(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"has no shards\.txt.*name a folder that `basu record dataset` has finished"):
        list(samples(tmp_path))


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--every", "0"], "--every is 0"),
        (["--per-shard", "0"], "--per-shard is 0"),
        (["--workers", "0"], "--workers is 0"),
        (["--drives", "-1"], "--drives is -1"),
        (["--resume"], "there is no data set in"),
        (["--sensors", "clash.json"], "would both write files that end with .front.png"),
        (["--sensors", "blind.json"], "has none; name a sensor file with cameras"),
        (["--sensors", "nowhere.json"], "nowhere.json"),
    ],
)
def test_bad_input_is_a_sentence_and_leaves_nothing(
    files: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    options: list[str],
    says: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    clash = [{**CAMERA, "id": "FRONT"}, {**CAMERA, "id": "front"}]
    Path("clash.json").write_text(json.dumps({"sensors": clash}))
    Path("blind.json").write_text(json.dumps({"sensors": [{"type": "sensor.other.gnss", "id": "GNSS"}]}))
    assert record(files, tmp_path / "set", *options) == 2
    assert says in capsys.readouterr().err
    assert not (tmp_path / "set").exists()


def test_a_data_set_stays_as_it_was_begun(files: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "set"
    folder.mkdir()
    (folder / "dataset.json").write_text(json.dumps({"version": 1, "conditions": {"--every": 7}, "drives": []}))
    assert record(files, folder) == 2
    assert "holds a data set already; add --resume" in capsys.readouterr().err
    assert record(files, folder, "--resume") == 2
    assert "--every was 7 and is 200" in capsys.readouterr().err


def test_a_campaign_that_searches_is_refused(tmp_path: Path, files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = CAMPAIGN.replace('sweep = 2\nvary = ["ahead"]', "search = {drives = 8, first = 4, batch = 2}")
    (tmp_path / "campaign.toml").write_text(text)
    (tmp_path / "rig.json").write_bytes((files / "rig.json").read_bytes())
    assert record(tmp_path, tmp_path / "set") == 2
    assert "has a search, which chooses drives by the verdicts of others" in capsys.readouterr().err


@pytest.mark.slow
def test_shards_have_no_times_and_no_owners(dataset: Path) -> None:
    for line in (dataset / "shards.txt").read_text().splitlines():
        with tarfile.open(dataset / line) as tar:
            assert {(entry.mtime, entry.uid, entry.uname) for entry in tar} == {(0, 0, "")}
            names = tar.getnames()
        assert names == sorted(names)
