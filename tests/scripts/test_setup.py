"""Kernels that `scripts/setup` compiles beside the installation need only the packages that it installs first."""

import re
import subprocess
import sys
from importlib.metadata import packages_distributions
from pathlib import Path

SETUP = (Path(__file__).parents[2] / "scripts" / "setup").read_text(encoding="utf-8")
MODULES = (
    "linden.cli.compiling",
    "linden.physics.warming",
    "linden.maps.cache",
    "linden.scenery.ray_query",
    "linden.sensors.compiling",
    "linden.sensors.warming",
)
"""Of the groups that it compiles."""
PROGRAM = """
import importlib, sys

class Refused:
    def find_spec(name, path=None, target=None):
        if name in refused:
            raise ModuleNotFoundError(f"{name} is not installed yet", name=name)

refused = set(sys.argv[1].split())
for name in refused & set(sys.modules):
    del sys.modules[name]
sys.meta_path.insert(0, Refused)
for module in sys.argv[2:]:
    importlib.import_module(module)
"""


def test_modules_of_these_kernels_import_with_the_first_packages_alone() -> None:
    first = re.search(r'"\$\{install\[@\]\}" ([\w ]+); then', SETUP)
    assert first is not None
    there = {*first.group(1).split(), "llvmlite"}  # numba needs it
    names = {name for name, found in packages_distributions().items() if not there & {each.lower() for each in found}}
    refused = names - there - {"linden", "basu", "coverage"}
    assert {"msgpack", "pydantic", "carla"} <= refused
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, " ".join(refused), *MODULES], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
