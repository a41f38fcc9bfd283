"""Rays against triangles: one scene that stands, bodies posed anew each tick, and who answers for them."""
