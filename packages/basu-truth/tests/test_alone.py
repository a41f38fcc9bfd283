"""A bare map that does not answer is a sentence that says what to do."""

from unittest.mock import Mock

import pytest

from basu.errors import SimulatorError
from basu_truth import alone


def test_a_bare_map_that_is_late_names_the_option_and_its_server_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    server, bare = Mock(), Mock()
    bare.world.get_settings.side_effect = RuntimeError("time-out of 20000ms while waiting for the simulator")
    monkeypatch.setattr(alone, "OwnServer", lambda: server)
    monkeypatch.setattr(alone, "connect", Mock())
    monkeypatch.setattr(alone, "AloneWorld", lambda *_, **__: bare)
    late = (
        r"failed at the preparation of the bare map: time-out .*; if the machine is busy, wait longer with --timeout S"
    )
    with pytest.raises(SimulatorError, match=late), alone.alone_world("Linden", (), 0.05, 20.0):
        pass
    bare.close.assert_called_once_with()
    server.end.assert_called_once_with()
