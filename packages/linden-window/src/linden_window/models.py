"""The models of actors as glTF 2.0: one node for each part, with the frame that it follows, and lamps by kind."""

import gzip
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from linden.blueprints.library import packaged
from linden.blueprints.skeleton import FULL_SWING_MPS, skeleton
from linden.scenery.actors.actor_meshes import actor_meshes
from linden.scenery.actors.posing import VEHICLE_FRAMES, WALKER_BONES
from linden.scenery.gltf import Buffer
from linden_window.tiles import GZIP_LEVEL, document_of, quantisation, surfaces

if TYPE_CHECKING:
    from linden.scenery.actors.actor_meshes import Part


class Models:
    """The models of all blueprints, each made when a page first needs it."""

    def __init__(self) -> None:
        self._made: dict[tuple[str, str], bytes | None] = {}

    def file(self, type_id: str, choice: str) -> bytes | None:
        """Return the compressed model of a blueprint; None if nothing of its actors can be seen.

        ``choice`` is the rider or the wheelchair that the actor was spawned with, "" for none.
        """
        key = type_id, choice
        if key not in self._made:
            all_parts = actor_meshes().all_parts
            parts = all_parts.get(key) or all_parts.get((type_id, ""))
            self._made[key] = None if not parts else gzip.compress(self._model(type_id, parts), GZIP_LEVEL, mtime=0)
        return self._made[key]

    def _model(self, type_id: str, parts: "Sequence[Part]") -> bytes:
        vehicle = packaged().find(type_id).vehicle
        hubs = []
        if vehicle is not None:  # x, y and radius of each wheel, m
            wheels = vehicle.physics.wheels
            hubs = [(at.x, at.y, wheels[nth].radius / 100.0) for nth, at in enumerate(vehicle.wheel_offsets_m)]
        buffer, nodes, meshes, looks = Buffer(), list[dict[str, Any]](), list[dict[str, Any]](), list[int]()
        for part in parts:
            mesh = actor_meshes().meshes[part.mesh]
            corners = mesh.vertices_m[mesh.triangles]
            low, scale = quantisation(corners)
            primitives, used = surfaces(buffer, corners, mesh.faces, low, scale)
            for primitive in primitives:
                primitive["material"] += len(looks)
            looks += used
            extras: dict[str, Any] = {
                "frame": part.frame,
                "colour": part.colour,
                "low": low[[0, 2, 1]].tolist(),
                "step": scale,
                "hubs": hubs,
            }
            nodes.append({"mesh": len(meshes), "extras": extras})
            meshes.append({"primitives": primitives})
        return document_of(buffer, nodes, meshes, looks)


def gait() -> dict[str, Any]:
    """Return what the page needs to pose parts: names of frames, bones with their offsets, and the gait."""
    bones = skeleton()
    wanted: set[int] = set()
    feet = [bones.names.index(f"crl_{part}__{side}") for part in ("foot", "toe") for side in "LR"]
    for start in (*(bones.names.index(name) for name in WALKER_BONES), *feet):
        row = start
        while row >= 0:
            wanted.add(row)
            row = bones.parents[row]
    rows = sorted(wanted)
    return {
        "vehicle_frames": VEHICLE_FRAMES,
        "walker_bones": WALKER_BONES,
        "names": [bones.names[row] for row in rows],
        "parents": [rows.index(bones.parents[row]) if bones.parents[row] >= 0 else -1 for row in rows],
        "offsets": bones.offsets[rows].tolist(),
        "feet": [rows.index(row) for row in feet],
        "standing": bones.standing[feet].tolist(),
        "stride": bones.stride,
        "share": bones.gait_share.tolist(),
        "angles_deg": {joint: angles.tolist() for joint, angles in bones.gait_deg.items()},
        "full_swing_mps": FULL_SWING_MPS,
    }
