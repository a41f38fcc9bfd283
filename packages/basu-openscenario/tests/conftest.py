"""The plugin as its distribution's entry points declare it, whether or not that is installed."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from basu import plugins

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[1]


@pytest.fixture
def plugin(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Install the entry point of `pyproject.toml` for this process, and return the folder for others' PYTHONPATH."""
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["entry-points"]
    lines = [
        "[basu.scenario_files]",
        *(f"{name} = {value}" for name, value in declared[plugins.SCENARIO_FILES].items()),
    ]
    folder = tmp_path_factory.mktemp("plugin")
    info = folder / "basu_openscenario_under_test-0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: basu-openscenario-under-test\nVersion: 0\n")
    (info / "entry_points.txt").write_text("\n".join(lines) + "\n")
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, [str(folder), os.environ.get("PYTHONPATH")])))
    plugins.offered.cache_clear()
    yield folder
    plugins.offered.cache_clear()
