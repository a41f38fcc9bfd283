"""Check whether kernels are compiled on this machine already, without loading them."""

import hashlib
import json
import os
import sys
from pathlib import Path
from typing import NamedTuple

import numba
from numba.core.dispatcher import Dispatcher

from linden.compiled import COMPILER_IS_OFF, TARGET, machine
from linden.maps.cache import MapCache

_PACKAGE = Path(__file__).parent.parent
_SHIPPED = _PACKAGE / "kernels.json"
"""Written by scripts/build_wheel.py: what the kernels beside the sources were compiled for."""


class Kernels(NamedTuple):
    """Kernels that are compiled together."""

    sources: tuple[str, ...]
    """Patterns of the files that they are compiled from."""
    modules: tuple[str, ...]
    """Beginnings of the names of their modules."""


OF_SENSORS = Kernels(("sensors/**/*.py", "compiled.py"), ("linden.sensors",))
OF_PHYSICS = Kernels(("physics/**/*.py", "maps/ground.py", "compiled.py"), ("linden.physics", "linden.maps.ground"))


def compile_once(cache: MapCache) -> None:
    """Compile what sensors that look around need, unless it was on this machine and is still there.

    So a start compiles what is not compiled, and loads no kernel before its first use.
    """
    if is_compiled(OF_SENSORS, cache):
        return
    from linden.sensors.warming import warm_up  # noqa: PLC0415 - a start that finds it compiled does without

    warm_up()
    note_compiled(OF_SENSORS, cache)


def is_compiled(kernels: Kernels, cache: MapCache) -> bool:
    """Return whether kernels were compiled on this machine, and what was compiled is still there.

    A wheel may bring them. Where numba's compiler is off there is nothing to compile.
    """
    if COMPILER_IS_OFF or _are_shipped():
        return True
    files = cache.kept(_name(kernels), lambda: b"[]", _files_of)
    return bool(files) and all(map(os.path.exists, files))


def note_compiled(kernels: Kernels, cache: MapCache) -> None:
    """Note that kernels are compiled; this process has loaded them."""
    cache.replace(_name(kernels), json.dumps(_compiled_files(kernels)).encode())


def versions() -> dict[str, str]:
    """Return the versions that compiled kernels are made for, and no others."""
    return {"python": "{}.{}".format(*sys.version_info), "numba": numba.__version__}


def _are_shipped() -> bool:
    """Return whether the wheel has brought kernels for these versions and for this processor."""
    try:
        shipped = json.loads(_SHIPPED.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return False
    return bool(shipped["versions"] == versions() and TARGET in shipped["targets"])


def _files_of(content: bytes) -> list[str]:
    """Return the names of files that are kept.

    Raises:
        ValueError: these are none.
    """
    files = json.loads(content)
    if not isinstance(files, list) or not all(isinstance(file, str) for file in files):
        raise ValueError("no list of files")
    return files


def _name(kernels: Kernels) -> str:
    """Return a file's name that tells what numba goes by: the sources as they lie there, the machine."""
    sources = sorted(file for pattern in kernels.sources for file in _PACKAGE.glob(pattern))
    stamps = [(str(file), file.stat().st_mtime_ns, file.stat().st_size) for file in sources]
    where = os.environ.get("NUMBA_CACHE_DIR")
    return f"{hashlib.sha256(f'{stamps} {where} {machine()}'.encode()).hexdigest()[:32]}.compiled"


def _compiled_files(kernels: Kernels) -> list[str]:
    """Return the files of machine code beside those of the kernels that were loaded or compiled."""
    modules = [module for name, module in sys.modules.items() if name.startswith(kernels.modules)]
    loaded = [thing for module in modules for thing in vars(module).values() if isinstance(thing, Dispatcher)]
    folders = {kernel.stats.cache_path for kernel in loaded}
    return sorted(str(file) for folder in folders if folder for file in Path(folder).glob("*.nb[ci]"))
