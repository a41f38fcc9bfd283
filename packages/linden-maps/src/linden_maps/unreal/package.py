"""The folder that CARLA's ``make import`` takes: description, OpenDRIVE, FBX; and the same mesh as glTF and USD.

Source: Util/BuildTools/Import.py of CARLA 0.9.16. It takes every .json file below its folder ``Import`` for a
description, so the manifest here is YAML.
"""

import hashlib
import json
import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from linden.errors import UserError
from linden_maps.unreal.fbx import fbx
from linden_maps.unreal.glb import glb
from linden_maps.unreal.parts import FOLDER_OF_GROUP, Part
from linden_maps.unreal.usd import write_usd

MANIFEST, README = "manifest.yaml", "README.md"
_MOVED_BY_CARLA = frozenset({"Road", "RoadLines", "SideWalk", "Terrain"})


class Names(NamedTuple):
    """Names of the package and of its map."""

    package: str
    map: str

    def is_ours(self, name: str) -> bool:
        """Return whether the package's folder holds a file or folder of that name."""
        return name in {f"{self.package}.json", self.map, MANIFEST, README}


def names_of(map_name: str) -> Names:
    """Return the names of a map's package.

    Raises:
        UserError: the map's name is none that Unreal takes.
    """
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", map_name):
        raise UserError(
            f"{map_name!r} is no name for a map in Unreal; rename the file: letters, digits and _, a letter first"
        )
    return Names(f"{map_name}Package", map_name)


def write_package(stage: Path, names: Names, opendrive: bytes, parts: Sequence[Part], *, usd: bool) -> None:
    """Write the package's files into an empty folder.

    Raises:
        UserError: USD is wanted, and its package is not installed.
    """
    folder = stage / names.map
    folder.mkdir()
    (folder / f"{names.map}.xodr").write_bytes(opendrive)
    (folder / f"{names.map}.fbx").write_bytes(fbx(parts, names.map))
    (folder / f"{names.map}.glb").write_bytes(glb(parts, names.map))
    if usd:
        write_usd(parts, names.map, folder / f"{names.map}.usdc")
    (stage / f"{names.package}.json").write_bytes(_description(names))
    (stage / README).write_text(_readme(names, parts), encoding="utf-8")
    (stage / MANIFEST).write_bytes(_manifest(stage, names, opendrive))


def _description(names: Names) -> bytes:
    """Return the package's JSON: paths are relative to its own folder."""
    one = {
        "name": names.map,
        "source": f"./{names.map}/{names.map}.fbx",
        "xodr": f"./{names.map}/{names.map}.xodr",
        "use_carla_materials": True,
    }
    return (json.dumps({"maps": [one], "props": []}, indent=2) + "\n").encode()


def _readme(names: Names, parts: Sequence[Part]) -> str:
    count = Counter(part.group for part in parts)
    left = sorted(group for group in count if FOLDER_OF_GROUP[group] not in _MOVED_BY_CARLA)
    rows = "\n".join(
        f"| `{names.map}_{group}_*` | {count[group]} | `Static/{FOLDER_OF_GROUP[group]}` | "
        f"{'make import' if FOLDER_OF_GROUP[group] in _MOVED_BY_CARLA else 'you, in the editor'} |"
        for group in sorted(count)
    )
    return f"""# {names.map} for CARLA built on Unreal

1. Copy this folder to `Import/{names.package}` of a CARLA 0.9.16 source build.
2. Run `make import` there. This needs the Unreal Editor build of CARLA.
3. In the editor, move the meshes of {", ".join(left) or "no further group"}
   from `Content/{names.package}/Maps/{names.map}` into `Content/{names.package}/Static/<class>`, so that semantic
   cameras see their class.
4. Run `make package ARGS="--packages={names.package}"` for a packaged CARLA.

| meshes | objects | semantic folder | moved by |
|---|---|---|---|
{rows}

CARLA places lights and signs itself, from the signals of `{names.map}.xodr`. They are not in the meshes.
Frame: x east, y north, z up, in centimetres (FBX) or metres (glTF, USD), with the origin of the OpenDRIVE file.
Steps 1 to 4 were not tried: they need an Unreal build. Independent readers opened the files.
"""


def _manifest(stage: Path, names: Names, opendrive: bytes) -> bytes:
    """Return source, frame, and the size and hash of every file; JSON, which is YAML too."""
    files = sorted(path for path in stage.rglob("*") if path.is_file())
    return (
        json.dumps(
            {
                "map": names.map,
                "source": {"format": "OpenDRIVE", "sha256": hashlib.sha256(opendrive).hexdigest()},
                "frame": "x east, y north, z up, origin of the OpenDRIVE file; FBX in cm, glTF (y up) and USD in m",
                "files": {
                    path.relative_to(stage).as_posix(): {
                        "bytes": path.stat().st_size,
                        "sha256": hashlib.sha256(path.read_bytes()).hexdigest(),
                    }
                    for path in files
                },
            },
            indent=2,
        )
        + "\n"
    ).encode()
