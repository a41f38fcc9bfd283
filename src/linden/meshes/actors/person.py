"""People on foot."""

from linden.meshes.actors.shape import Shape
from linden.meshes.actors.solids import Look, ball, rod, tagged
from linden.meshes.mesh import Material
from linden.meshes.posing import WALKER_FRAMES
from linden.world.blueprints import Blueprint

SHIRT = Look(Material.CLOTH, (150, 60, 60))
TROUSERS = Look(Material.CLOTH, (50, 60, 90))
SKIN = Look(Material.SKIN, (200, 150, 120))


def person(blueprint: Blueprint) -> list[Shape]:
    """Return the parts of a walker."""
    h = 2.0 * blueprint.box.extent.z
    made = {
        "crl_hips__C": rod((0, 0, -0.05 * h), (0, 0, 0.1 * h), 0.09 * h, TROUSERS),
        "crl_spine01__C": rod((0, 0, -0.1 * h), (0, 0, 0.12 * h), 0.09 * h, SHIRT),
        "crl_Head__C": ball((0, 0, 0.055 * h), (0.05 * h, 0.04 * h, 0.064 * h), SKIN),
    }
    for side in "LR":
        made[f"crl_arm__{side}"] = rod((0, 0, 0), (0, 0, -0.186 * h), 0.025 * h, SHIRT)
        made[f"crl_foreArm__{side}"] = rod((0, 0, 0), (0, 0, -0.23 * h), 0.02 * h, SKIN)
        made[f"crl_thigh__{side}"] = rod((0, 0, 0), (0, 0, -0.245 * h), 0.04 * h, TROUSERS)
        made[f"crl_leg__{side}"] = rod((0, 0, 0), (0, 0, -0.246 * h), 0.03 * h, TROUSERS)
        made[f"crl_foot__{side}"] = rod((-0.03 * h, 0, -0.03 * h), (0.11 * h, 0, -0.03 * h), 0.01 * h, TROUSERS)
    tag = blueprint.semantic_tags[0]
    return [Shape(tagged(mesh, tag), WALKER_FRAMES.index(bone)) for bone, mesh in made.items()]
