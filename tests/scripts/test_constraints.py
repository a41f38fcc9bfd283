"""Claims about constraints.txt: one version of each package for each supported Python, which admits that Python."""

from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name

PYTHONS = ("3.10", "3.11", "3.12")
PINS = [
    Requirement(line)
    for line in (Path(__file__).parents[2] / "constraints.txt").read_text("utf-8").splitlines()
    if line.strip()
]


def pins_for(python: str) -> list[Requirement]:
    """The pins that pip obeys under this Python."""
    where = {"python_version": python, "python_full_version": f"{python}.0"}
    return [pin for pin in PINS if pin.marker is None or pin.marker.evaluate(where)]


def test_each_line_pins_one_version() -> None:
    assert [str(pin) for pin in PINS if [each.operator for each in pin.specifier] != ["=="]] == []


@pytest.mark.parametrize("python", PYTHONS)
def test_each_package_has_one_version_under_each_python(python: str) -> None:
    names = [canonicalize_name(pin.name) for pin in pins_for(python)]
    assert sorted(names) == sorted(set(names))
    assert {"carla", "numba", "ipython", "pytest"} <= set(names)


@pytest.mark.parametrize("python", PYTHONS)
def test_a_pinned_version_that_is_installed_here_admits_each_python_that_it_is_pinned_for(python: str) -> None:
    compared = 0
    for pin in pins_for(python):
        try:
            installed = metadata(pin.name)
        except PackageNotFoundError:
            continue
        if pin.specifier.contains(installed["Version"]):
            compared += 1
            assert SpecifierSet(installed.get("Requires-Python") or "").contains(f"{python}.0"), f"{pin} and {python}"
    assert compared > 20
