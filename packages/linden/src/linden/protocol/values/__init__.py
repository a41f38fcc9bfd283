"""CARLA's vocabulary as frozen named tuples: the fields stand in the order of the wire, so a value packs as it lies.

Source of names, order and defaults: LibCarla 0.9.16, ``carla/rpc`` and ``carla/geom``. Nothing here computes.
"""
