"""Claims about campaigns on a store: complete after every kill, and readable without the machine that drove it."""

import importlib
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import fsspec
import pyarrow as pa
import pytest

from basu.campaigns import command
from basu.campaigns.campaign_run import RunSettings
from basu.campaigns.columns import VOLATILE
from basu.campaigns.command import run_campaign
from basu.campaigns.drive_table import read_drives
from basu.campaigns.storage import Mirror, Store, fetch, is_address, local_copy
from basu.cli import main
from basu.errors import UserError

Write = Callable[..., Path]
BUCKET = "campaigns-of-a-test"


@pytest.fixture
def memory() -> Iterator[str]:
    """An address in this process's memory."""
    files = fsspec.filesystem("memory")
    yield "memory://store"
    files.store.clear()
    files.pseudo_dirs[:] = [""]


@pytest.fixture
def run(modules: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, here: None) -> Callable[..., None]:
    """A function that runs a campaign in this process."""
    monkeypatch.setattr(command, "drive_player", importlib.import_module(modules).spec)

    def play(file: Path, store: str | None, output: str = "work", **settings: Any) -> None:
        given = RunSettings(file=file, output=tmp_path / output, store=store, workers=2, **settings)
        assert run_campaign(given) == 0

    return play


def steady(folder: Path) -> pa.Table:
    """The rows without hosts and times."""
    return read_drives(folder).drop_columns(list(VOLATILE))


def plain_files(folder: Path) -> dict[str, bytes]:
    """All files of a campaign that belong on a store."""
    paths = [path for path in folder.rglob("*") if path.is_file() and not path.name.startswith(".")]
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}


@pytest.mark.parametrize("kind", ["memory", "file"])
def test_a_store_holds_what_the_folder_holds(
    kind: str, run: Callable[..., None], campaign: Write, memory: str, tmp_path: Path
) -> None:
    address = memory if kind == "memory" else f"file://{tmp_path}/store"
    run(campaign(), address)
    with local_copy(f"{address}/crossings") as (folder, store):
        assert store is not None
        found = plain_files(folder)
        assert found == plain_files(tmp_path / "work" / "crossings")
        assert steady(folder).num_rows == 60
    assert any(name.startswith("records/basic/") for name in found)
    assert not any("part" in name.rpartition("/")[2] or name.startswith("journal/") for name in found)


def test_a_campaign_goes_on_from_its_store_on_another_machine(
    run: Callable[..., None], campaign: Write, memory: str, tmp_path: Path
) -> None:
    file = campaign()
    run(file, memory, drives=21)  # two blocks of eight, and a part of the third
    shutil.rmtree(tmp_path / "work")
    run(file, memory, resume=True)
    run(file, None, "undisturbed")
    with local_copy(f"{memory}/crossings") as (folder, _):
        assert steady(folder).equals(steady(tmp_path / "undisturbed" / "crossings"))
        assert not list((folder / "journal").glob("*"))


@pytest.mark.measured_processes
def test_a_killed_command_leaves_only_complete_blocks(
    run: Callable[..., None], campaign: Write, memory: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file, copies = campaign(), list[int]()
    copy = Mirror.copy

    def die(mirror: Mirror, *, with_journals: bool = False) -> None:
        copies.append(1)
        if len(copies) == 4:
            raise SystemExit("killed")
        copy(mirror, with_journals=with_journals)

    monkeypatch.setattr(Mirror, "copy", die)
    with pytest.raises(SystemExit):
        run(file, memory)
    shutil.rmtree(tmp_path / "work")
    monkeypatch.setattr(Mirror, "copy", copy)
    run(file, memory, resume=True)
    run(file, None, "undisturbed")
    with local_copy(f"{memory}/crossings") as (folder, _):
        assert steady(folder).equals(steady(tmp_path / "undisturbed" / "crossings"))


def test_status_and_report_take_an_address(
    run: Callable[..., None], campaign: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    address = f"file://{tmp_path}/store"
    run(campaign(), address)
    assert f"basu campaign report {address}/crossings" in capsys.readouterr().out
    assert main(["campaign", "status", f"{address}/crossings"]) == 0
    assert "drives    60 of 60" in capsys.readouterr().out
    assert main(["campaign", "report", f"{address}/crossings"]) == 0
    assert capsys.readouterr().out == f"report  {address}/crossings/campaign.html\n"
    assert "Campaign crossings" in (tmp_path / "store" / "crossings" / "campaign.html").read_text(encoding="utf-8")


def test_a_store_that_refuses_is_one_sentence_and_loses_no_drive(
    run: Callable[..., None], campaign: Write, memory: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = campaign()

    def refuse(store: Store, name: str, data: bytes) -> None:
        with store._said("written", "go on with --resume, which loses no drive"):
            raise PermissionError("Access Denied")

    with monkeypatch.context() as patch:
        patch.setattr(Store, "write", refuse)
        with pytest.raises(UserError, match=r"memory://store/crossings could not be written: Access Denied; go on"):
            run(file, memory)
    assert read_drives(tmp_path / "work" / "crossings").num_rows >= 8
    run(file, memory, resume=True)
    with local_copy(f"{memory}/crossings") as (folder, _):
        assert read_drives(folder).num_rows == 60


def test_a_half_written_object_is_never_seen(tmp_path: Path) -> None:
    store = Store(f"file://{tmp_path}/store")
    store.write("one.json", b"before")
    with pytest.raises(UserError, match="could not be written"):
        store.write("one.json", "no bytes")  # type: ignore[arg-type]
    assert store.read("one.json") == b"before"
    assert store.names() == ["one.json"]


def test_mistakes_with_a_store_are_one_sentence(run: Callable[..., None], campaign: Write, memory: str) -> None:
    file = campaign()
    with pytest.raises(UserError, match="nothing://here/crossings cannot be opened: "):
        run(file, "nothing://here")
    run(file, memory, drives=2)
    with pytest.raises(UserError, match="memory://store/crossings holds a campaign already; add --resume"):
        run(file, memory, "elsewhere")
    with (
        pytest.raises(UserError, match="there is no campaign at memory://store/none"),
        local_copy("memory://store/none"),
    ):
        pass
    assert is_address("s3://bucket/folder")
    assert not is_address("campaigns/crossings")
    assert not is_address("C:/campaigns")


def test_a_campaign_on_an_s3_server(
    run: Callable[..., None], campaign: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where moto and s3fs are installed: they want an older python-dateutil than the notebooks' pandas here."""
    pytest.importorskip("s3fs")
    server_module = pytest.importorskip("moto.server")
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
        monkeypatch.setenv(name, "testing")
    server = server_module.ThreadedMotoServer(ip_address="127.0.0.1", port=0)
    server.start()
    host, port = server.get_host_and_port()
    monkeypatch.setitem(fsspec.config.conf, "s3", {"client_kwargs": {"endpoint_url": f"http://{host}:{port}"}})
    try:
        fsspec.filesystem("s3").mkdir(BUCKET)
        file = campaign()
        run(file, f"s3://{BUCKET}/lab", drives=21)
        shutil.rmtree(tmp_path / "work")
        run(file, f"s3://{BUCKET}/lab", resume=True)
        run(file, None, "undisturbed")
        folder = tmp_path / "fetched"
        fetch(Store(f"s3://{BUCKET}/lab/crossings"), folder)
        assert steady(folder).equals(steady(tmp_path / "undisturbed" / "crossings"))
        assert any((folder / "records").iterdir())
    finally:
        server.stop()
