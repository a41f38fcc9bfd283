"""Write the asset of actor meshes, ``linden/data/actor_meshes.xz``, from the models in ``linden_maps.models``."""

from pathlib import Path

import linden
from linden.scenery.actors.actor_meshes import ASSET
from linden_maps.models.all_blueprints import write_asset

if __name__ == "__main__":
    write_asset(Path(linden.__file__).parent / ASSET)
