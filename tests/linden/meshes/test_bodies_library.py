"""Claims about the meshes of all blueprints as they are kept."""

from pathlib import Path

import numpy as np

from linden.meshes.bodies import Bodies
from linden.meshes.bodies_library import bodies_of
from linden.world.blueprints import BlueprintLibrary
from linden.world.map_cache import MapCache

LIBRARY = BlueprintLibrary.load()


def test_what_was_kept_is_what_was_made_and_lies_where_it_can_be_read_in_place(tmp_path: Path) -> None:
    made, cache = Bodies(LIBRARY), MapCache(tmp_path)
    for kept in (bodies_of(LIBRARY, cache), bodies_of(LIBRARY, cache)):
        assert kept.all_parts.keys() == made.all_parts.keys()
        for ours, theirs in zip(made.meshes, kept.meshes, strict=True):
            assert all(np.array_equal(one, other) for one, other in zip(ours, theirs, strict=True))
            assert theirs.vertices_m.flags.aligned
            assert theirs.triangles.flags.aligned
