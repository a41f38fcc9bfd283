"""Choice of the ray caster for a device, and the check that this machine has the device."""

import importlib.util
import logging

from linden.errors import UserError
from linden.scenery.mesh import Mesh
from linden.sensors.casting.caster import CPU, Caster
from linden.sensors.casting.embree import EmbreeCaster
from linden.sensors.casting.embree_library import NoEmbreeError
from linden.sensors.casting.embreex_caster import EmbreexCaster

log = logging.getLogger("linden")


def check_device(device: str) -> None:
    """Refuse a device on which nothing could be cast.

    Raises:
        UserError: it is no GPU, or what drives it is not installed.
    """
    if device == CPU:
        return
    if any(importlib.util.find_spec(name) is None for name in ("warp", "numba_cuda")):
        raise UserError(f"--device {device} needs NVIDIA's Warp and numba for its GPUs: pip install 'linden[gpu]'")
    import warp  # noqa: PLC0415 - half a second that only users of a GPU pay

    known = [CPU, *(gpu.alias for gpu in warp.get_cuda_devices())]
    if device not in (*known, *(["cuda"] if len(known) > 1 else [])):
        raise UserError(f"--device {device}: here there is {', '.join(known)}")


def caster_of(standing: Mesh, bodies: list[Mesh], device: str = CPU) -> Caster:
    """Return a caster for what stands and the meshes that bodies may have: the fastest that works on the device."""
    if device != CPU:
        from linden.sensors.casting.warp_caster import WarpCaster  # noqa: PLC0415 - see check_device

        return WarpCaster(standing, bodies, device)
    try:
        return EmbreeCaster(standing, bodies)
    except NoEmbreeError as error:
        log.warning("sensors that look around will be slow: %s; embreex's own call is used instead", error)
    return EmbreexCaster(standing, bodies)
