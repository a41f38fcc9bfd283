"""The walking mesh of an episode's map, clear of what stands on it."""

from linden.navigation.library import MeshFile, MeshLibrary
from linden.navigation.tile import Obstacles
from linden.simulation.episode import Episode
from linden.simulation.scenery import scenery_of


def mesh_file(episode: Episode, meshes: MeshLibrary) -> MeshFile | None:
    """Return the mesh as clients fetch it; None where the map has no pavements."""
    statics = scenery_of(episode.map).statics  # all of it, whatever clients made disappear: the file is the map's
    return meshes.file_of(episode.map, Obstacles(statics.centre, statics.half, statics.yaw_rad))
