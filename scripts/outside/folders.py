"""Where the outside programs lie, and what stands for those folders in their arguments."""

from pathlib import Path
from typing import NamedTuple

WITHIN = {
    "examples": "carla/PythonAPI/examples",
    "older_examples": "older/PythonAPI/examples",
    "util": "carla/PythonAPI/util",
    "test": "carla/PythonAPI/test",
    "scenario_runner": "scenario_runner",
    "leaderboard": "leaderboard",
    "scenic": "scenic",
    "sumo": "sumo",
    "kitti": "kitti_carla_simulator",
    "boxes": "CARLA-2DBBox",
    "gym": "gym-carla",
}
"""Where the programs of a family lie below the folder of all of them; README.md says how they get there."""


class Folders(NamedTuple):
    """The folders of one run, all of them absolute."""

    programs: Path
    towns: Path
    """CARLA's maps as OpenDRIVE files."""
    osm: Path
    """An OpenStreetMap extract."""
    sumo_home: Path
    """SUMO's folder: ``sumo`` in the site-packages of whoever installed eclipse-sumo."""
    out: Path
    """Where everything is left that is written."""

    def of(self, family: str) -> Path:
        """The folder in which the programs of a family are started."""
        return self.programs / WITHIN[family]

    def filled(self, argument: str) -> str:
        """An argument with the folders put in."""
        for name in ("towns", "osm", "out"):
            argument = argument.replace("{" + name + "}", str(getattr(self, name)))
        return argument
