"""Whether all that sensors that look around need is compiled on this machine already, without loading it."""

import hashlib
import json
import os
import sys
from pathlib import Path

from numba.core.dispatcher import Dispatcher

from linden.compiled import machine
from linden.maps.cache import MapCache

_PACKAGE = Path(__file__).parent.parent
_COMPILED = ("sensors/**/*.py", "compiled.py")


def compile_once(cache: MapCache) -> None:
    """Compile everything, unless it was done on this machine and the compiled files are still there.

    So a start compiles what is not compiled, and does not load what no sensor needs yet.
    """
    name = _name()
    files = cache.kept(name, lambda: b"[]", _files_of)
    if files and all(map(os.path.exists, files)):
        return
    from linden.sensors.warming import warm_up  # noqa: PLC0415 - a start that finds it compiled does without

    warm_up()
    cache.replace(name, json.dumps(_compiled_files()).encode())


def _files_of(content: bytes) -> list[str]:
    """Return the names of files that are kept.

    Raises:
        ValueError: these are none.
    """
    files = json.loads(content)
    if not isinstance(files, list) or not all(isinstance(file, str) for file in files):
        raise ValueError("no list of files")
    return files


def _name() -> str:
    """Return a file's name that tells what numba goes by: the sources as they lie there, the machine."""
    sources = sorted(file for pattern in _COMPILED for file in _PACKAGE.glob(pattern))
    stamps = [(str(file), file.stat().st_mtime_ns, file.stat().st_size) for file in sources]
    where = os.environ.get("NUMBA_CACHE_DIR")
    return f"{hashlib.sha256(f'{stamps} {where} {machine()}'.encode()).hexdigest()[:32]}.compiled"


def _compiled_files() -> list[str]:
    """Return the files of machine code beside those of the kernels that were loaded or compiled."""
    modules = [module for name, module in sys.modules.items() if name.startswith("linden.sensors")]
    kernels = [thing for module in modules for thing in vars(module).values() if isinstance(thing, Dispatcher)]
    folders = {kernel.stats.cache_path for kernel in kernels}
    return sorted(str(file) for folder in folders if folder for file in Path(folder).glob("*.nb[ci]"))
