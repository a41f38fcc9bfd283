"""Linden's network, converted once."""

from importlib import resources
from pathlib import Path

import pytest

from linden_maps.sumo.network import ConvertedNetwork, convert
from tracing import untraced_here

pytest.importorskip("sumo", reason="the extra for SUMO is not installed")


@pytest.fixture(scope="session")
def linden(tmp_path_factory: pytest.TempPathFactory) -> tuple[ConvertedNetwork, Path]:
    """What was converted, and the file of the network."""
    target = tmp_path_factory.mktemp("sumo") / "Linden.net.xml"
    text = (resources.files("linden") / "data" / "Linden.xodr").read_bytes()
    with untraced_here():  # to write the folder takes the same lines
        return convert(text, target), target
