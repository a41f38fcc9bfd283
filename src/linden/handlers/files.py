"""Files that the client fetches and keeps: the walking mesh. Source: LibCarla 0.9.16 and ``CarlaServer.cpp``."""

from linden.errors import Refusal
from linden.handlers.context import Context
from linden.handlers.registry import Long, method
from linden.navigation.library import MeshFile
from linden.simulation.walking_mesh import mesh_file


def _mesh(context: Context) -> Long[MeshFile | None]:
    """Return the mesh of the map that is loaded; where it is not known, it is made in the background."""
    episode = context.simulation.episode
    if context.meshes.knows(episode.map):
        return mesh_file(episode, context.meshes)
    made: MeshFile | None = yield lambda: mesh_file(episode, context.meshes)
    return made


@method("get_required_files")
def get_required_files(context: Context, folder: str) -> Long[list[str]]:
    """Return the files of a folder that a client should have: "Nav" has the walking mesh, "" all there are.

    There is none in "TM": the Traffic Manager works its map out of the OpenDRIVE text, which ``get_map_data`` returns.
    """
    mesh = (yield from _mesh(context)) if folder.strip("/") in ("", "Nav") else None
    return [mesh.name] if mesh else []


@method("request_file")
def request_file(context: Context, name: str) -> Long[bytes]:
    """Return a file of ``get_required_files``."""
    mesh = yield from _mesh(context)
    if mesh is None or name != mesh.name:
        offered = f"it offers {mesh.name}" if mesh else "its map has no pavements, so it offers none"
        raise Refusal(f"file '{name}' not found on this server; {offered}")
    return mesh.content


@method("get_navigation_mesh")
def get_navigation_mesh(context: Context) -> Long[bytes]:
    """Return the walking mesh; empty where the map has no pavements."""
    mesh = yield from _mesh(context)
    return mesh.content if mesh else b""
