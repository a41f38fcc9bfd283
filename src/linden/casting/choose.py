"""Which caster answers on this machine."""

from linden.casting.embree import EmbreeCaster
from linden.casting.rays import Caster
from linden.meshes.mesh import Mesh


def caster_of(standing: Mesh, bodies: list[Mesh]) -> Caster:
    """Return a caster for what stands and the meshes that bodies may have."""
    return EmbreeCaster(standing, bodies)
