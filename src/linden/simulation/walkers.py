"""Walkers in the simulation: the mesh they are led over, and how one that is led moves, dies and is taken away."""

from linden.navigation.library import MeshFile, MeshLibrary
from linden.navigation.tile import Obstacles
from linden.simulation.episode import Episode


def mesh_file(episode: Episode, meshes: MeshLibrary) -> MeshFile | None:
    """Return the walking mesh of the episode's map, clear of its scenery; None where it has no pavements."""
    statics = episode.statics
    return meshes.file_of(episode.map, Obstacles(statics.centre, statics.half, statics.yaw_rad))
