"""Tests of ``linden.cli``."""

from importlib.metadata import EntryPoint

import pytest

from linden.cli import main


def test_a_plugin_that_cannot_be_loaded_is_named_and_takes_no_other_command_along(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    broken = EntryPoint("map", "no_such_module:add_parser", "linden.commands")
    monkeypatch.setattr("importlib.metadata.entry_points", lambda **_: [broken])
    with pytest.raises(SystemExit):
        main(["--help"])
    said = capsys.readouterr()
    assert "serve" in said.out
    assert "warning: the plugin that brings `linden map` cannot be loaded" in said.err
    assert main(["map", "list"]) == 2
    assert "cannot be loaded (No module named 'no_such_module'); install it again" in capsys.readouterr().err
