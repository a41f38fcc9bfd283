"""Meshes of props by blueprint, each stretched to the blueprint's box."""

from collections.abc import Callable

import numpy as np

from linden.blueprints.library import Blueprint
from linden.protocol.values.enums import SemanticTag
from linden.protocol.values.space import BoundingBox
from linden.scenery.mesh import Mesh, join
from linden_maps.models.props import garden, plants, small, street
from linden_maps.models.props import warning_signs as signs
from linden_maps.models.solids import Shape, bounds, stretched, tagged

Model = Callable[[float, float, float], list[Mesh]]

_MODELS: dict[str, Model] = {
    "advertisement": signs.advertisement,
    "aporosatree": plants.broad_tree,
    "atm": street.machine((60, 90, 140)),
    "barbeque": garden.barbecue,
    "barrel": small.barrel,
    "bench01": street.bench(back=True),
    "bench02": street.bench(back=False),
    "bench03": street.bench(back=False),
    "bike helmet": small.helmet((200, 60, 40)),
    "bin": street.wheeled_bin((40, 90, 60)),
    "box01": small.cardboard(open_lid=False),
    "box02": small.cardboard(open_lid=False),
    "box03": small.cardboard(open_lid=True),
    "briefcase": small.case((70, 44, 28)),
    "busstop": street.shelter(along_x=True),
    "busstoplb": street.shelter(along_x=False),
    "calibrator": small.boards,
    "chainbarrier": street.chain_barrier,
    "chainbarrierend": street.bollard,
    "clothcontainer": street.container((150, 160, 170)),
    "clothesline": garden.clothes_line,
    "coconutpalm": plants.palm,
    "colacan": small.can((190, 20, 24)),
    "constructioncone": signs.cone,
    "container": street.container((60, 110, 70)),
    "creasedbox01": small.cardboard(open_lid=True),
    "creasedbox02": small.cardboard(open_lid=True),
    "creasedbox03": small.boards,
    "cypresstree": plants.cypress,
    "doghouse": garden.dog_house,
    "foodcart": street.food_cart,
    "fountain": garden.fountain,
    "garbage01": small.can((150, 150, 146)),
    "garbage03": small.can((160, 60, 40)),
    "garbage04": small.can((60, 110, 70)),
    "gardenlamp": garden.lamp,
    "glasscontainer": street.container((40, 120, 80)),
    "gnome": garden.gnome,
    "guitarcase": small.case((30, 28, 30)),
    "haybale": small.hay,
    "haybalelb": small.hay,
    "ironplank": small.boards,
    "kiosk_01": street.kiosk,
    "mailbox": street.mailbox,
    "maptable": signs.map_table,
    "mobile": small.case((20, 22, 26)),
    "motorhelmet": small.helmet((30, 32, 40)),
    "pergola": garden.pergola,
    "plantpot06": plants.round_pot,
    "plantpot05": plants.round_pot,
    "plantpot07": plants.round_pot,
    "plantpot08": plants.round_pot,
    "plasticchair": garden.chair,
    "plastictable": garden.parasol_table,
    "purse": small.bag((120, 50, 60), handles=True),
    "shoppingbag": small.bag((220, 210, 190), handles=True),
    "shoppingcart": small.shopping_cart,
    "shoppingtrolley": small.trolley((60, 80, 120)),
    "slide": garden.slide,
    "streetbarrier": signs.barrier,
    "streetfountain": street.drinking_fountain,
    "streetsign": signs.sign_board,
    "streetsign01": signs.sign_board,
    "streetsign04": signs.sign_board,
    "swing": garden.swing,
    "swingcouch": garden.swing_couch,
    "table": garden.table,
    "trafficcone01": signs.cone,
    "trafficcone02": signs.cone,
    "trafficwarning": signs.arrow_board,
    "trampoline": garden.trampoline,
    "travelcase": small.trolley((40, 60, 70)),
    "vendingmachine": street.machine((170, 30, 34)),
    "warningaccident": signs.warning_sign,
    "warningconstruction": signs.warning_sign,
    "wateringcan": garden.watering_can,
}

_BEGINNING: dict[str, Model] = {
    "brokentile": small.boards,
    "dirtdebris": small.heap((104, 86, 64)),
    "garbage": small.heap((150, 146, 138)),
    "plantpot": plants.planter,
    "plasticbag": small.bag((226, 228, 230), handles=True),
    "platformgarbage": small.heap((120, 112, 96)),
    "trashbag": small.bag((28, 28, 32), handles=False),
    "trashcan": street.litter_bin,
    "mesh": small.cube,
}
"""Those of several numbers, by how their names begin."""


def model(name: str, box: BoundingBox) -> list[Mesh]:
    """Return the solids of a prop about as large as its box, standing on the origin.

    Raises:
        KeyError: there is no model of it; a test checks that every blueprint has one.
    """
    size_m = (2.0 * box.extent.x, 2.0 * box.extent.y, 2.0 * box.extent.z)
    if name in _MODELS:
        return _MODELS[name](*size_m)
    return next(make for start, make in _BEGINNING.items() if name.startswith(start))(*size_m)


def prop(blueprint: Blueprint) -> list[Shape]:
    """Return a prop's one part."""
    tag = blueprint.semantic_tags[0] if blueprint.semantic_tags else SemanticTag.STATIC
    name = blueprint.definition.id.removeprefix("static.prop.")
    return [Shape(tagged(_fitted(join(model(name, blueprint.box)), blueprint.box), tag), 0)]


def _fitted(mesh: Mesh, to: BoundingBox) -> Mesh:
    """Return the mesh stretched and moved so that it fills a box."""
    low, high = bounds(mesh)
    centre, half = np.array(to.location), np.array(to.extent)
    factors = 2.0 * half / np.maximum(high - low, 1e-6)
    return stretched(mesh, factors.tolist(), (centre - factors * 0.5 * (low + high)).tolist())
