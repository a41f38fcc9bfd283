from importlib import resources

import pytest

from linden.authoring.lanelet2.convert import convert
from linden.maps.opendrive.parse import parse


@pytest.fixture(scope="session")
def linden():
    return parse((resources.files("linden") / "data" / "Linden.xodr").read_bytes())


@pytest.fixture(scope="session")
def linden_lanelets(linden):
    return convert(linden)
