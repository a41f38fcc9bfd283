"""Large texts are read in a process of their own: the result is the same, and that process always ends."""

import logging
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from threading import Event

import psutil
import pytest

sys.path.insert(0, str(Path(__file__).parents[4] / "tests"))

from fakes.crafted_maps import opendrive
from linden.background import NotWantedError, in_background
from linden.errors import Refusal, UserError
from linden.maps import reading_process
from linden.maps.archive import pack_reading
from linden.maps.cache import MapCache
from linden.maps.library import MapLibrary
from linden.maps.opendrive.limits import MapError
from linden.maps.reading import read
from linden.maps.reading_process import LARGE_BYTES, read_text
from opendrive_texts import street_through_junction

STREET = street_through_junction()


@pytest.fixture
def all_are_large(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reading_process, "LARGE_BYTES", 0)


def readers() -> list[psutil.Process]:
    """Return the processes that read maps for this one."""
    return [child for child in psutil.Process().children() if child.is_running() and _reads_maps(child)]


def _reads_maps(process: psutil.Process) -> bool:
    try:
        return reading_process.__name__ in " ".join(process.cmdline())
    except psutil.Error:  # it ended meanwhile
        return False


def until(holds: Callable[[], object], at_most_s: float = 60.0) -> None:
    ends_s = time.monotonic() + at_most_s
    while not holds():
        assert time.monotonic() < ends_s
        time.sleep(0.005)


@pytest.mark.parametrize("walls_beyond_m", [None, 2.0])
@pytest.mark.usefixtures("all_are_large")
def test_a_process_reads_what_would_be_read_here(walls_beyond_m: float | None) -> None:
    apart, here = (pack_reading(reader(STREET, walls_beyond_m)) for reader in (read_text, read))
    assert [(name, array.tobytes()) for name, array in apart.items()] == [
        (name, array.tobytes()) for name, array in here.items()
    ]
    assert (len(apart["wall_feet_m"]) > 0) == (walls_beyond_m is not None)


@pytest.mark.usefixtures("all_are_large")
def test_a_process_uses_facts_that_are_known() -> None:
    known = replace(read(STREET).facts, geo_origin_deg=(12.0, 34.0))
    apart = read_text(STREET, 2.0, known)
    assert apart.facts.geo_origin_deg == (12.0, 34.0)
    assert apart.wall_feet_m.tobytes() == read(STREET, 2.0).wall_feet_m.tobytes()


@pytest.mark.usefixtures("all_are_large")
def test_a_mistake_gives_the_sentence_that_it_gives_here() -> None:
    broken = STREET.replace('length="', 'length="-', 1)
    with pytest.raises(MapError) as here:
        read(broken)
    with pytest.raises(MapError) as apart:
        read_text(broken)
    assert str(here.value).startswith("line ")
    assert (str(apart.value), apart.value.line) == (str(here.value), here.value.line)


@pytest.mark.usefixtures("all_are_large")
def test_what_is_logged_there_is_logged_here(caplog: pytest.LogCaptureFixture) -> None:
    tiny = '<laneSection s="0"><center><lane id="0" type="none"/></center></laneSection>'
    text = STREET.replace("<laneSection", f"{tiny}<laneSection", 1)
    with caplog.at_level(logging.WARNING, "linden"):
        read_text(text)
    assert "a <laneSection> without length" in caplog.text


def test_a_large_map_that_is_given_up_ends_its_process() -> None:
    text, unwanted = opendrive("buildings", 20_000), Event()
    assert len(text) > LARGE_BYTES
    made = in_background(lambda: read_text(text), unwanted)
    until(readers)
    unwanted.set()
    with pytest.raises(NotWantedError):
        made.result(10)
    assert readers() == []


def test_a_process_that_is_killed_is_a_refusal_with_its_signal(tmp_path: Path) -> None:
    text, library = opendrive("buildings", 20_000), MapLibrary((), MapCache(tmp_path).read)
    made = in_background(lambda: library.from_opendrive(text))
    until(readers)
    readers()[0].kill()
    with pytest.raises(Refusal, match="ended by signal 9; if the machine has too little memory"):
        made.result(10)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("all_are_large")
def test_a_failure_of_the_program_is_no_fault_of_the_map(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(reading_process, "_PROGRAM", "raise ValueError('a mistake of ours')")
    with pytest.raises(RuntimeError, match="ended with status 1"):
        read_text(STREET)
    assert "a mistake of ours" in capfd.readouterr().err


@pytest.mark.usefixtures("all_are_large")
def test_a_machine_without_room_for_files_refuses(monkeypatch: pytest.MonkeyPatch) -> None:
    def full() -> object:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("tempfile.TemporaryFile", full)
    with pytest.raises(UserError, match=r"No space left on device; make room in .*TMPDIR"):
        read_text(STREET)


def peak_mb() -> float:
    """Return the most memory that this process has held since the last reset, in MB."""
    (line,) = (line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) / 1000.0


def test_this_process_holds_little_while_a_large_map_is_read(tmp_path: Path) -> None:
    library = MapLibrary((), MapCache(tmp_path).read)
    library.from_opendrive(STREET)
    text = opendrive("buildings", 40_000)
    Path("/proc/self/clear_refs").write_text("5")  # resets the peak, as of proc(5)
    before_mb = peak_mb()
    library.from_opendrive(text)
    assert peak_mb() - before_mb < 100.0
