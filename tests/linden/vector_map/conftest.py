from importlib import resources

import pytest

from linden.opendrive.parse import parse
from linden.vector_map.lanelet2.convert import convert


@pytest.fixture(scope="session")
def linden():
    return parse((resources.files("linden") / "data" / "Linden.xodr").read_bytes())


@pytest.fixture(scope="session")
def linden_lanelets(linden):
    return convert(linden)
