"""Draws a part of an FBX file as assimp reads it, to look at it with other eyes than ours: Pillow's polygons by depth.

``python scripts/outside/render_fbx.py MAP.fbx X Y SIDE -o PICTURE.png``: a square of SIDE m about (X, Y) of the map,
seen from the south at 45 degrees. Faces have the colour of their material, shaded by their normal.
"""

import argparse
from pathlib import Path

import assimp_py
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

F64 = NDArray[np.float64]

SIZE_PX = 1400
TILT_RAD = np.radians(45.0)
SUN = np.array([-0.4, -0.5, 0.77])
_GREY = (0.6, 0.6, 0.6)
_FLAT, _LOW_M = 0.95, 1.5


def main() -> None:
    """Write the picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("window", nargs=3, type=float, metavar=("X", "Y", "SIDE"))
    parser.add_argument("-o", "--output", type=Path, required=True)
    arguments = parser.parse_args()
    corners, colours = triangles_of(arguments.file, arguments.window)
    picture(corners, colours, arguments.window).save(arguments.output)
    print(f"{arguments.output}: {len(corners):,} triangles")


def triangles_of(path: Path, window: list[float]) -> tuple[F64, F64]:
    """Return the corners (N, 3, 3) in m and colours (N, 3) of the triangles in a window; the file is in cm."""
    scene = assimp_py.import_file(str(path), assimp_py.Process_Triangulate)
    corners, colours = [], []
    for mesh in scene.meshes:
        places = np.array(mesh.vertices, np.float64).reshape(-1, 3) / 100.0
        faces = places[np.array(mesh.indices, np.int64).reshape(-1, 3)]
        middle = faces.mean(axis=1)
        inside = (np.abs(middle[:, :2] - window[:2]) < window[2] / 2.0).all(axis=1)
        material = scene.materials[mesh.material_index]
        colour = next((value for key, value in material.items() if "DIFFUSE" in str(key).upper()), _GREY)
        corners.append(faces[inside])
        colours.append(np.tile(np.asarray(colour, np.float64)[:3], (int(inside.sum()), 1)))
    return np.concatenate(corners), np.concatenate(colours)


def picture(corners: F64, colours: F64, window: list[float]) -> Image.Image:
    """Return the picture: the ground first, then far triangles before near ones."""
    x_m, y_m, side_m = window
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-12)[:, None]
    shade = 0.45 + 0.55 * np.abs(normal @ SUN)
    ground_m = float(np.median(corners[..., 2]))
    local = corners - (x_m, y_m, ground_m)
    up = local[..., 1] * np.sin(TILT_RAD) + local[..., 2] * np.cos(TILT_RAD)
    depth = local[..., 1] * np.cos(TILT_RAD) - local[..., 2] * np.sin(TILT_RAD)
    scale = SIZE_PX / side_m
    places = np.stack([SIZE_PX / 2 + scale * local[..., 0], SIZE_PX / 2 - scale * up], axis=-1)
    made = Image.new("RGB", (SIZE_PX, SIZE_PX), (176, 200, 222))
    draw = ImageDraw.Draw(made)
    fill = np.clip(255.0 * colours * shade[:, None], 0, 255).astype(int)
    lies = (np.abs(normal[:, 2]) > _FLAT) & (local[..., 2].max(axis=1) < _LOW_M)  # the ground, in large triangles
    for row in np.lexsort([-depth.mean(axis=1), ~lies]).tolist():
        draw.polygon([tuple(place) for place in places[row].tolist()], fill=tuple(fill[row].tolist()))
    return made


if __name__ == "__main__":
    main()
