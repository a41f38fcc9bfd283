"""Motion of bodies: the stages of a step. ``bodies.Bodies`` holds them, ``step.advance`` moves them."""

from linden.physics.warming import warm_up

__all__ = ["warm_up"]
