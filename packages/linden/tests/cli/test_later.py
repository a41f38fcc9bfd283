"""Claims about commands that are imported when they are typed."""

import argparse
import sys
from pathlib import Path

import pytest

from linden.cli.later import later
from linden.errors import UserError


def test_a_command_is_imported_when_it_runs() -> None:
    name = "linden.cli.map_list"
    sys.modules.pop(name, None)
    command = later(f"{name}:run")
    assert name not in sys.modules
    assert command(argparse.Namespace()) == 0


def test_a_missing_package_of_an_extra_is_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "needy.py").write_text("import no_such_package\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(UserError, match=r"needs the package no_such_package; .* pip install 'linden\[maps\]'"):
        later("needy:run", "maps")(argparse.Namespace())
    with pytest.raises(ModuleNotFoundError):
        later("needy:run")(argparse.Namespace())
