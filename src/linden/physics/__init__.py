"""How bodies move: stages of a step, one idea a file. ``bodies.Bodies`` is what moves, ``step.advance`` moves it."""

from linden.physics.warming import warm_up

__all__ = ["warm_up"]
