"""Data of a block of rays while it is shaded: an array of floats, field after field, one of whole numbers."""

BLOCK = 256
"""Rays; what is known of them fits into a processor's nearest memory, and those of one material are still many.

Each field is BLOCK long, so the compiler sees that what a loop writes is not what it reads, and does eight at once.
"""

(
    FAR, PIXEL, SUNNY, DX, DY, DZ, X, Y, Z, BX, BY, BZ, FX, FY, FZ, NX, NY, NZ, RED, GREEN, BLUE,
    GLOW, GLOSS, BEND, LAMP_RED, LAMP_GREEN, LAMP_BLUE, GLINT, END,
) = range(0, 29 * BLOCK, BLOCK)  # fmt: skip
FLOATS = END
MATERIAL, ORDER, FIRST = range(0, 3 * BLOCK, BLOCK)
WHOLE_NUMBERS = 3 * BLOCK
