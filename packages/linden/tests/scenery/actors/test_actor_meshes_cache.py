"""Bodies' meshes out of the cache."""

from pathlib import Path

import numpy as np
import pytest

from linden.blueprints.library import BlueprintLibrary
from linden.maps.cache import MapCache
from linden.scenery.actors import actor_meshes_cache as bodies_library
from linden.scenery.actors.actor_meshes import Bodies
from linden.scenery.actors.actor_meshes_cache import bodies_of, keep_bodies


def test_what_is_kept_is_what_was_made_and_is_not_made_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    library, cache = BlueprintLibrary.load(), MapCache(tmp_path)
    keep_bodies(library, cache)
    monkeypatch.setattr(bodies_library, "_made", lambda _library: pytest.fail("they are kept"))
    kept, made = bodies_of(library, cache), Bodies(library)
    assert kept.all_parts == made.all_parts
    assert len(kept.meshes) == len(made.meshes)
    for here, there in zip(kept.meshes, made.meshes, strict=True):
        for column, expected in zip(here, there, strict=True):
            assert column.dtype == expected.dtype
            np.testing.assert_array_equal(column, expected)
