"""How the parts of actors look: colours and materials that several of them share."""

from linden.meshes.actors.solids import Look
from linden.meshes.mesh import LampOf, Material

PAINT = Look(Material.CAR_PAINT, (190, 190, 190), painted=True)
GLASS = Look(Material.GLASS, (28, 33, 38))
TRIM = Look(Material.PLAIN, (32, 32, 34))
RUBBER = Look(Material.RUBBER, (24, 24, 25))
RIM = Look(Material.METAL, (165, 168, 172))
CHROME = Look(Material.METAL, (200, 202, 205))
STEEL = Look(Material.METAL, (120, 123, 126))
BLACK = Look(Material.PLAIN, (18, 18, 19))
PLATE = Look(Material.SIGN_FACE, (235, 235, 228))

HEAD = Look(Material.LAMP, (225, 230, 235), LampOf.HEAD)
TAIL = Look(Material.LAMP, (150, 14, 12), LampOf.TAIL)
BRAKE = Look(Material.LAMP, (120, 12, 10), LampOf.BRAKE)
REVERSE = Look(Material.LAMP, (215, 215, 215), LampOf.REVERSE)
BLINKER_LEFT = Look(Material.LAMP, (205, 110, 15), LampOf.BLINKER_LEFT)
BLINKER_RIGHT = Look(Material.LAMP, (205, 110, 15), LampOf.BLINKER_RIGHT)
BEACON_BLUE = Look(Material.LAMP, (30, 60, 190), LampOf.BEACON)
BEACON_RED = Look(Material.LAMP, (190, 25, 20), LampOf.BEACON)
