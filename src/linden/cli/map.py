"""``linden map``: build OpenDRIVE from streets, check, draw and count it, export what is seen, measure it by lidar."""

import argparse
from collections.abc import Callable
from pathlib import Path

from linden.authoring.output import write_output
from linden.cli import map_build, map_convert, map_package, map_pointcloud, map_sumo
from linden.cli.map_source import built_in_maps, opendrive_of, world_map_of


def add_parser(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command ``map`` with its own commands."""
    maps = commands.add_parser("map", help="build, check, show and count maps", description=__doc__)
    actions = maps.add_subparsers(title="commands", required=True, metavar="COMMAND")

    map_build.add_arguments(_add(actions, "build", map_build.run, map_build.HELP))

    check_parser = _add(actions, "check", check, "report what a careful reader finds wrong; exit 1 if anything is")
    _add_file(check_parser)
    check_parser.add_argument("--against", metavar="MAP", help="the OpenDRIVE map that a Lanelet2 file was made of")
    check_parser.add_argument("--notes", action="store_true", help="tell also what is odd but allowed")

    show_parser = _add(actions, "show", show, "draw a map")
    _add_file(show_parser)
    show_parser.add_argument("--over", metavar="MAP", help="the OpenDRIVE map to draw below a Lanelet2 or Aisan one")
    show_parser.add_argument(
        "--window", nargs=3, type=float, metavar=("X", "Y", "SIDE"), help="draw a square of a Lanelet2 or Aisan map, m"
    )
    show_parser.add_argument("-o", "--output", type=Path, required=True, help="where to write the .svg file")

    export_parser = _add(actions, "export", export, "write all that stands on a map as glTF, for any 3D viewer")
    _add_file(export_parser)
    export_parser.add_argument("-o", "--output", type=Path, required=True, help="where to write the .glb file")

    _add(actions, "list", list_maps, "print the names of the built-in maps")

    info_parser = _add(actions, "info", info, "count roads, junctions, signals, lanes")
    _add_file(info_parser)

    convert_parser = _add(actions, "convert", map_convert.run, map_convert.HELP)
    map_convert.add_arguments(convert_parser)

    package_parser = _add(actions, "package", map_package.run, map_package.HELP)
    map_package.add_arguments(package_parser)

    cloud_parser = _add(actions, "pointcloud", map_pointcloud.run, map_pointcloud.HELP)
    map_pointcloud.add_arguments(cloud_parser)

    map_sumo.add_arguments(_add(actions, "sumo", map_sumo.run, map_sumo.HELP))


def check(arguments: argparse.Namespace) -> int:
    """Print the findings, one a line, and a summary; return 1 if there are any."""
    if Path(arguments.file).suffix == ".osm":
        return map_convert.check(Path(arguments.file), arguments.against)
    if Path(arguments.file).is_dir():
        return map_convert.check_folder(Path(arguments.file))
    # here, not above: the server's start does not pay for it
    from linden.authoring.checks.check import Severity  # noqa: PLC0415 - see above
    from linden.authoring.checks.check import check as findings_of  # noqa: PLC0415 - see above

    findings = findings_of(opendrive_of(arguments.file))
    wrong = [finding for finding in findings if finding.severity is not Severity.NOTE]
    for finding in findings if arguments.notes else wrong:
        _say(str(finding))
    notes = len(findings) - len(wrong)
    told = "" if arguments.notes or not notes else "; --notes tells them"
    _say(f"{arguments.file}: {_number(len(wrong), 'finding')}, {_number(notes, 'note')}{told}")
    return 1 if wrong else 0


def show(arguments: argparse.Namespace) -> int:
    """Write a drawing of the map."""
    from linden.authoring.drawing.svg import svg  # noqa: PLC0415 - the server's start does not pay for it

    vector_map = map_convert.drawing(arguments)
    drawn = svg(opendrive_of(arguments.file)) if vector_map is None else vector_map
    write_output(arguments.output, drawn.encode())
    _say(f"{arguments.output}: drawn")
    return 0


def export(arguments: argparse.Namespace) -> int:
    """Write the standing mesh of the map as binary glTF."""
    from linden.authoring.gltf import glb  # noqa: PLC0415 - the server's start does not pay for it
    from linden.maps.opendrive.parse import parse  # noqa: PLC0415 - see above
    from linden.scenery.map_mesh import standing  # noqa: PLC0415 - see above
    from linden.simulation.surroundings import scenery_of  # noqa: PLC0415 - see above

    world_map = world_map_of(arguments.file)
    mesh = standing(parse(world_map.text), world_map, scenery_of(world_map).scene)
    write_output(arguments.output, glb(mesh, world_map.name))
    _say(f"{arguments.output}: {len(mesh.triangles):,} triangles, {arguments.output.stat().st_size:,} bytes")
    return 0


def info(arguments: argparse.Namespace) -> int:
    """Print what the map has, one count a line, then its named places."""
    from linden.authoring.statistics import count, named_places  # noqa: PLC0415 - the server's start does not pay for it

    opendrive = opendrive_of(arguments.file)
    for name, value in count(opendrive)._asdict().items():
        _say(f"{name.replace('_', ' '):24} {f'{value:.2f}' if isinstance(value, float) else value}")
    for place in named_places(opendrive):
        _say(f"{'place':24} {place}")
    return 0


def list_maps(_arguments: argparse.Namespace) -> int:
    """Print the names of the built-in maps, one a line."""
    for name in built_in_maps():
        _say(name)
    return 0


def _add(
    actions: "argparse._SubParsersAction[argparse.ArgumentParser]",
    name: str,
    command: Callable[[argparse.Namespace], int],
    text: str,
) -> argparse.ArgumentParser:
    parser = actions.add_parser(name, help=text, description=f"{text[0].upper()}{text[1:]}.")
    parser.set_defaults(command=command)
    return parser


def _add_file(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", help="an OpenDRIVE file, or the name of a built-in map such as Linden")


def _number(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _say(line: str) -> None:
    print(line)  # noqa: T201 - what a command says to its user
