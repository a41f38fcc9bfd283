"""A shuffled order of numbers that needs no list: a permutation of 0..size-1, the same for the same seed."""

from __future__ import annotations

import hashlib

ROUNDS = 4  # Luby and Rackoff 1988: four rounds of good functions look random


class Shuffle:
    """A Feistel network on the smallest square domain, with cycle walking back into the range.

    Black and Rogaway 2002, "Ciphers with arbitrary finite domains", section 3 (cycle walking) and 4 (Feistel).
    """

    def __init__(self, size: int, seed: int) -> None:
        """Take the number of places, and the seed of their order."""
        self.size, self._seed = size, seed
        self._half_bits = max(1, ((max(size, 2) - 1).bit_length() + 1) // 2)

    def __call__(self, place: int) -> int:
        """The number at a place of the order, which is in 0..size-1."""
        number = self._once(place)
        while number >= self.size:
            number = self._once(number)
        return number

    def _once(self, number: int) -> int:
        mask = (1 << self._half_bits) - 1
        left, right = number >> self._half_bits, number & mask
        for round_ in range(ROUNDS):
            text = f"{self._seed} {self.size} {round_} {right}".encode()
            mixed = int.from_bytes(hashlib.blake2b(text, digest_size=8).digest(), "big")
            left, right = right, left ^ (mixed & mask)
        return (left << self._half_bits) | right
