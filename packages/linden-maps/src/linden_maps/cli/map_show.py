"""``linden map show``: a drawing of an OpenDRIVE, Lanelet2 or Aisan map."""

import argparse
from pathlib import Path

from linden.errors import UserError
from linden_maps.aisan.reading import read_folder
from linden_maps.cli.map_convert import lanelets_of
from linden_maps.cli.map_source import opendrive_of
from linden_maps.cli.output import say
from linden_maps.drawing.svg import svg
from linden_maps.drawing.vector_maps import Window, aisan_svg, lanelet2_svg
from linden_maps.output import write_output


def run(arguments: argparse.Namespace) -> int:
    """Write a drawing of the map."""
    vector_map = _of_vector_map(arguments)
    drawn = svg(opendrive_of(arguments.file)) if vector_map is None else vector_map
    write_output(arguments.output, drawn.encode())
    say(f"{arguments.output}: drawn")
    return 0


def _of_vector_map(arguments: argparse.Namespace) -> str | None:
    """Return the drawing of a Lanelet2 file or an Aisan folder, None for anything else."""
    path = Path(arguments.file)
    is_lanelet2 = path.suffix == ".osm"
    if not is_lanelet2 and not path.is_dir():
        if arguments.over or arguments.window:
            raise UserError("--over and --window are for Lanelet2 and Aisan maps; name a .osm file or a folder")
        return None
    under = None if arguments.over is None else opendrive_of(arguments.over)
    window = None if arguments.window is None else Window(*arguments.window)
    if is_lanelet2:
        return lanelet2_svg(lanelets_of(arguments.file), under, window)
    return aisan_svg(read_folder(path), under, window)
