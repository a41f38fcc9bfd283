"""LZF, the packing inside of binary_compressed PCD files: the unpacking half.

Source of the format: Marc Lehmann's LibLZF, the comment over lzf_decompress. A byte below 32 goes before that many
literal bytes and one; any other has a length in its upper three bits (7: go on in the next byte) and, with the byte
after, how far back the copy begins.
"""

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel

U8 = NDArray[np.uint8]


def unpack(packed: U8, size: int) -> U8 | None:
    """Return the ``size`` bytes that were packed, None where ``packed`` is no packing of so many."""
    out = np.empty(size, np.uint8)
    return out if _unpack(packed, out) else None


@kernel
def _unpack(packed: U8, out: U8) -> bool:
    at, made, size = 0, 0, len(out)
    while at < len(packed):
        control = int(packed[at])
        at += 1
        if control < 32:
            length = control + 1
            if at + length > len(packed) or made + length > size:
                return False
            for _ in range(length):
                out[made] = packed[at]
                at += 1
                made += 1
            continue
        length = control >> 5
        if length == 7:
            if at >= len(packed):
                return False
            length += int(packed[at])
            at += 1
        if at >= len(packed):
            return False
        source = made - (((control & 31) << 8) | int(packed[at])) - 1
        at += 1
        if source < 0 or made + length + 2 > size:
            return False
        for _ in range(length + 2):  # byte by byte: a copy may reach into what it makes
            out[made] = out[source]
            source += 1
            made += 1
    return made == size
