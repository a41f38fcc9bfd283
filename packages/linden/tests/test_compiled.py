"""How compiled functions are kept on disk, and what happens to a file that is of no use."""

import importlib.util
import pickle
from pathlib import Path
from types import ModuleType

import pytest

from linden.compiled import COMPILER_IS_OFF

pytestmark = pytest.mark.skipif(COMPILER_IS_OFF, reason="nothing is compiled")
KERNEL = """
from linden.compiled import kernel, kept_part

@kernel
def twice(number: float) -> float:
    return 2.0 * number

@kept_part({sources})
def thrice(number: float) -> float:
    return 3.0 * number
"""


def load(folder: Path, sources: int = 7) -> ModuleType:
    """Import a module with two kernels anew, as a process that starts does."""
    file = folder / "kernels.py"
    if not file.exists():
        file.write_text(KERNEL.format(sources="__import__('os').stat(__file__).st_mode and SOURCES"), encoding="utf-8")
    spec = importlib.util.spec_from_file_location("kernels", file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    module.SOURCES = sources
    spec.loader.exec_module(module)
    return module


def hits(module: ModuleType, name: str) -> int:
    """Return how often a kernel was found on disk, after one call."""
    kernel = getattr(module, name)
    assert kernel(2.0) in {4.0, 6.0}
    return sum(kernel.stats.cache_hits.values())


@pytest.mark.parametrize("name", ["twice", "thrice"])
def test_a_second_process_finds_what_the_first_compiled(tmp_path: Path, name: str) -> None:
    assert [hits(load(tmp_path), name) for _ in range(2)] == [0, 1]


def test_a_part_is_compiled_anew_when_a_file_that_it_calls_changes(tmp_path: Path) -> None:
    assert [hits(load(tmp_path, sources), "thrice") for sources in (7, 8, 8)] == [0, 0, 1]


@pytest.mark.parametrize("name", ["twice", "thrice"])
def test_what_lies_beside_the_source_is_found_where_another_folder_is_written_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    hits(load(tmp_path), name)
    monkeypatch.setattr("numba.core.config.CACHE_DIR", str(tmp_path / "elsewhere"))
    assert hits(load(tmp_path), name) == 1
    assert not list((tmp_path / "elsewhere").rglob("*.nb?"))


class Gone:
    """Stands for a class that has moved since the file was written."""

    def __reduce__(self) -> tuple[object, ...]:
        return (importlib.import_module, ("linden.no_such_module",))


@pytest.mark.parametrize("index", [b"", b"no pickle", None], ids=["empty", "no pickle", "of a class that has moved"])
def test_a_file_that_cannot_be_read_is_made_anew(tmp_path: Path, index: bytes | None) -> None:
    hits(load(tmp_path), "twice")
    (file,) = (tmp_path / "__pycache__").glob("kernels.twice*.nbi")
    if index is None:
        version = pickle.loads(file.read_bytes())
        index = pickle.dumps(version) + pickle.dumps((b"stamp", {Gone(): "x"}))
    file.write_bytes(index)
    assert [hits(load(tmp_path), "twice") for _ in range(2)] == [0, 1]


def test_where_no_folder_can_be_written_it_is_compiled_for_this_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("numba.core.caching._CacheLocator.ensure_cache_path", _refuse)
    assert hits(load(tmp_path), "twice") == 0
    assert not list(tmp_path.rglob("*.nb?"))


def _refuse(_locator: object) -> None:
    raise PermissionError(13, "Permission denied")
