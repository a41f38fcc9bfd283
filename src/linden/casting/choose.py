"""Which caster answers on this machine."""

import logging

from linden.casting.embree import EmbreeCaster
from linden.casting.embree_library import NoEmbreeError
from linden.casting.rays import Caster
from linden.meshes.mesh import Mesh

log = logging.getLogger("linden")


def caster_of(standing: Mesh, bodies: list[Mesh]) -> Caster:
    """Return a caster for what stands and the meshes that bodies may have: the fastest that works here."""
    try:
        return EmbreeCaster(standing, bodies)
    except NoEmbreeError as error:
        log.warning("sensors that look around will be slow: %s; embreex's own call is used instead", error)
    from linden.casting.embreex_caster import EmbreexCaster  # noqa: PLC0415 - where Embree works, it is not needed

    return EmbreexCaster(standing, bodies)
