"""Whether a start has to compile what sensors that look need."""

from pathlib import Path

import pytest

from linden.maps.cache import MapCache
from linden.sensors import compiling, warming
from linden.sensors.compiling import compile_once


@pytest.fixture
def warmed(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return a list that grows each time that all kernels are compiled or loaded."""
    times: list[str] = []
    monkeypatch.setattr(warming, "warm_up", lambda: times.append("warm"))
    return times


@pytest.fixture
def machine_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a file that stands for what was compiled."""
    file = tmp_path / "kernel.nbc"
    file.touch()
    monkeypatch.setattr(compiling, "_compiled_files", lambda _kernels: [str(file)])
    return file


def test_a_second_start_finds_what_the_first_compiled(tmp_path: Path, warmed: list[str], machine_code: Path) -> None:
    assert machine_code.exists()
    for _ in range(2):
        compile_once(MapCache(tmp_path / "kept"))
    assert warmed == ["warm"]


def test_machine_code_that_was_removed_is_made_again(tmp_path: Path, warmed: list[str], machine_code: Path) -> None:
    cache = MapCache(tmp_path / "kept")
    compile_once(cache)
    machine_code.unlink()
    compile_once(cache)
    assert warmed == ["warm", "warm"]


def test_where_machine_code_lies_elsewhere_it_is_looked_up_there(
    tmp_path: Path, warmed: list[str], machine_code: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert machine_code.exists()
    cache = MapCache(tmp_path / "kept")
    compile_once(cache)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "elsewhere"))
    compile_once(cache)
    assert warmed == ["warm", "warm"]


@pytest.mark.parametrize("content", [b"", b"7", b"[7]", b"{", b"\xff"])
def test_a_list_that_is_none_is_made_again(
    tmp_path: Path, warmed: list[str], machine_code: Path, content: bytes
) -> None:
    assert machine_code.exists()
    cache = MapCache(tmp_path / "kept")
    cache.replace(compiling._name(compiling.OF_SENSORS), content)
    for _ in range(2):
        compile_once(cache)
    assert warmed == ["warm"]
