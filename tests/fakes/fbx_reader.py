"""What the reader ufbx finds in an FBX file, as JSON: `python -m fakes.fbx_reader FILE`.

A process of its own, that ends at once: ufbx 0.0.5 crashes when its objects are freed in some orders.
"""

import json
import os
import sys

import ufbx


def main() -> None:
    """Print version, unit, axes, and triangles, vertices, materials and layers of each mesh."""
    scene = ufbx.load_file(sys.argv[1])
    kept = list(scene.meshes)
    meshes = {}
    for mesh in list(kept):
        materials = mesh.materials
        normal, texture = mesh.vertex_normal, mesh.vertex_uv
        meshes[mesh.name] = [mesh.num_triangles, mesh.num_vertices, len(materials), normal.exists, texture.exists]
        kept += [materials, normal, texture]
    settings, metadata = scene.settings, scene.metadata
    axes = settings.axes
    found = {
        "meshes": meshes,
        "unit_m": settings.unit_meters,
        "axes": [axis.name for axis in (axes.right, axes.up, axes.front)],
        "version": metadata.version,
        "is_ascii": bool(metadata.ascii),
    }
    sys.stdout.write(json.dumps(found))
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    main()
