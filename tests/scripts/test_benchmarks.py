"""Claims about benchmarks and scripts: what they import from the packages exists, and a tick's stages can be timed.

No other test runs them, so a name that changed in the packages would be noticed by the next user of a benchmark.
"""

import ast
import importlib
import importlib.util
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FILES = [*sorted((ROOT / "benchmarks").glob("*.py")), *sorted((ROOT / "scripts").rglob("*.py"))]
OF_EXTRAS = ("pxr", "lanelet2")
"""Packages of extras that the tests' installation may lack: modules that need them are not imported here."""


def imported(path: Path) -> Iterator[tuple[str, str]]:
    """Yield module and name of each import from the two packages, wherever it stands in a file."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] in {"linden", "basu"}:
            yield from ((node.module or "", alias.name) for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names if alias.name.partition(".")[0] in {"linden", "basu"})


def missing(module: str, name: str) -> bool:
    """Whether a module, or a name in it, does not exist; what an extra would bring counts as existing."""
    try:
        if name and hasattr(importlib.import_module(module), name):
            return False
        importlib.import_module(f"{module}.{name}" if name else module)
    except ModuleNotFoundError as error:
        return (error.name or "").partition(".")[0] not in OF_EXTRAS
    return False


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_what_is_imported_from_the_packages_exists(path: Path) -> None:
    assert [f"{module}.{name}" for module, name in imported(path) if missing(module, name)] == []


def test_the_stages_of_a_tick_can_be_timed(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    spec = importlib.util.spec_from_file_location("stages", ROOT / "benchmarks" / "stages.py")
    assert spec is not None
    assert spec.loader is not None
    stages = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(stages)
    monkeypatch.setattr(sys, "argv", ["stages.py", "--vehicles", "1", "--ticks", "1"])
    stages.main()
    head, row = capsys.readouterr().out.splitlines()
    assert head.split()[:5] == ["vehicles", "batch", "lights", "friction", "physics"]
    assert len(row.split()) == len(head.split())
