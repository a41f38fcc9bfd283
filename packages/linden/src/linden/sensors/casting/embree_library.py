"""The Embree library that lies inside the ``embreex`` wheel: found, loaded for kernels too, and its functions declared.

Embree 4's C interface, embree4/rtcore.h; the manual is at https://www.embree.org/api.html.
"""

import ctypes
import importlib.util
from functools import lru_cache
from pathlib import Path

import llvmlite.binding

_PLACES = ("../embreex.libs/libembree4*", ".dylibs/libembree4*", "../embreex.libs/embree4*.dll", "embree4*.dll")
"""Where wheels keep it under Linux, macOS and Windows, seen from the package."""

_VERSION = 0  # RTC_DEVICE_PROPERTY_VERSION
_NATIVE_PACKETS = {16: 34, 8: 33, 4: 32}  # RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED and so on
_KNOWN_VERSIONS = range(40000, 50000)
"""RTCRayHit is laid out alike in all of 4.x; ``packets`` relies on it."""

_HANDLE, _UINT, _INT, _SIZE = ctypes.c_void_p, ctypes.c_uint, ctypes.c_int, ctypes.c_size_t
_FUNCTIONS = {
    "rtcNewDevice": (_HANDLE, ctypes.c_char_p),
    "rtcReleaseDevice": (None, _HANDLE),
    "rtcGetDeviceError": (_INT, _HANDLE),
    "rtcGetDeviceProperty": (ctypes.c_ssize_t, _HANDLE, _INT),
    "rtcNewScene": (_HANDLE, _HANDLE),
    "rtcSetSceneFlags": (None, _HANDLE, _INT),
    "rtcSetSceneBuildQuality": (None, _HANDLE, _INT),
    "rtcCommitScene": (None, _HANDLE),
    "rtcReleaseScene": (None, _HANDLE),
    "rtcNewGeometry": (_HANDLE, _HANDLE, _INT),
    "rtcSetGeometryBuildQuality": (None, _HANDLE, _INT),
    "rtcSetSharedGeometryBuffer": (None, _HANDLE, _INT, _UINT, _INT, _HANDLE, _SIZE, _SIZE, _SIZE),
    "rtcSetGeometryInstancedScene": (None, _HANDLE, _HANDLE),
    "rtcSetGeometryEnableFilterFunctionFromArguments": (None, _HANDLE, ctypes.c_bool),
    "rtcEnableGeometry": (None, _HANDLE),
    "rtcDisableGeometry": (None, _HANDLE),
    "rtcCommitGeometry": (None, _HANDLE),
    "rtcAttachGeometryByID": (None, _HANDLE, _HANDLE, _UINT),
    "rtcReleaseGeometry": (None, _HANDLE),
}


class NoEmbreeError(Exception):
    """The library is not there, cannot be loaded or is another than this code knows; says which."""


@lru_cache(maxsize=1)
def embree() -> ctypes.CDLL:
    """Return the library, its functions declared; kernels find it from now on.

    Raises:
        NoEmbreeError: it cannot be used.
    """
    file = _file()
    try:
        library = ctypes.CDLL(str(file))
        for name, (result, *arguments) in _FUNCTIONS.items():
            function = getattr(library, name)
            function.restype, function.argtypes = result, arguments
        llvmlite.binding.load_library_permanently(str(file))
    except (OSError, AttributeError, RuntimeError) as error:
        raise NoEmbreeError(f"{file} cannot be loaded: {error}") from error
    device = library.rtcNewDevice(b"threads=1")
    version = library.rtcGetDeviceProperty(device, _VERSION)
    library.rtcReleaseDevice(device)
    if version not in _KNOWN_VERSIONS:
        raise NoEmbreeError(f"{file} is of version {version}; versions 4.x are known")
    return library


@lru_cache(maxsize=1)
def packet_width() -> int:
    """Return how many rays this processor takes at once: 16, 8 or 4."""
    library = embree()
    device = library.rtcNewDevice(b"threads=1")
    native = [width for width, asked in _NATIVE_PACKETS.items() if library.rtcGetDeviceProperty(device, asked)]
    library.rtcReleaseDevice(device)
    return max(native, default=4)


def _file() -> Path:
    spec = importlib.util.find_spec("embreex")
    if spec is None or spec.origin is None:
        raise NoEmbreeError("the package embreex is not installed")
    package = Path(spec.origin).parent
    found = [file for place in _PLACES for file in sorted(package.glob(place))]
    if not found:
        raise NoEmbreeError(f"there is no libembree4 beside {package}")
    return found[0].resolve()
