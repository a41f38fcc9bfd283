"""`Models` maps SUMO types and persons to CARLA blueprints; `CLASSES` maps CARLA base types to SUMO vehicle classes."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from basu.errors import UserError

if TYPE_CHECKING:
    import carla

BASE_TYPES = {
    "passenger": "car", "private": "car", "taxi": "car", "evehicle": "car", "hov": "car", "custom1": "car",
    "custom2": "car", "vip": "car", "authority": "car", "army": "car",
    "delivery": "van", "emergency": "van",
    "truck": "truck", "trailer": "truck",
    "bus": "bus", "coach": "bus",
    "motorcycle": "motorcycle", "moped": "motorcycle", "scooter": "motorcycle",
    "bicycle": "bicycle",
}  # fmt: skip
"""CARLA's base type by SUMO's vehicle class."""
CLASSES = {"car": "passenger", "van": "delivery", "truck": "truck", "bus": "bus", "motorcycle": "motorcycle",
           "bicycle": "bicycle"}  # fmt: skip

LENGTHS_M = {
    "vehicle.carlamotors.carlacola": 5.2, "vehicle.carlamotors.european_hgv": 7.9,
    "vehicle.mitsubishi.fusorosa": 10.3, "vehicle.mercedes.sprinter": 5.9, "vehicle.tesla.model3": 4.8,
    "vehicle.audi.a2": 3.7, "vehicle.volkswagen.t2": 4.5, "vehicle.nissan.patrol": 4.6,
    "vehicle.dodge.charger_2020": 5.0, "vehicle.yamaha.yzf": 2.2, "vehicle.vespa.zx125": 1.9,
    "vehicle.bh.crossbike": 1.5, "vehicle.diamondback.century": 1.6,
}  # fmt: skip
"""The lengths of stand-ins: a client learns a blueprint's length once it is spawned."""

WALKER_STRIDE = 7  # CARLA numbers its walkers by looks: consecutive ones are alike


class Model(NamedTuple):
    """How a type is shown. ``is_exact`` where the blueprint bears the type's name."""

    blueprint: str
    is_exact: bool


class Models:
    """The blueprints of a simulator, by SUMO's types."""

    def __init__(self, library: carla.BlueprintLibrary) -> None:
        """Read the names and base types of all vehicles."""
        self.base_types = {
            str(model.id): model.get_attribute("base_type").as_str() if model.has_attribute("base_type") else "car"
            for model in library.filter("vehicle.*")
        }
        self._library = library
        self._walkers = sorted(str(model.id) for model in library.filter("walker.pedestrian.*"))
        self._known: dict[str, Model] = {}
        self._colours: dict[str, tuple[str, ...]] = {}

    def of(self, kind: str, vehicle_class: str, length_m: float) -> Model:
        """Return the blueprint of a type: of its name, else the stand-in of its class that is most alike in length.

        Raises:
            UserError: no blueprint is of such a class.
        """
        if kind not in self._known:
            self._known[kind] = self._find(kind, vehicle_class, length_m)
        return self._known[kind]

    def walker(self, number: int) -> str:
        """Return the blueprint of the person of a number; neighbours in number look different.

        Raises:
            UserError: the simulator has no walkers.
        """
        if not self._walkers:
            raise UserError("this simulator has no blueprints of walkers; take the persons out of SUMO's demand")
        return self._walkers[number * WALKER_STRIDE % len(self._walkers)]

    def colours_of(self, blueprint: str) -> tuple[str, ...]:
        """Return the colours that are recommended for a blueprint; none for one without colours."""
        if blueprint not in self._colours:
            found = self._library.find(blueprint)
            has_any = found.has_attribute("color")
            self._colours[blueprint] = tuple(found.get_attribute("color").recommended_values) if has_any else ()
        return self._colours[blueprint]

    def _find(self, kind: str, vehicle_class: str, length_m: float) -> Model:
        name = kind.split("@", maxsplit=1)[0]  # SUMO numbers the copies of a type
        if name in self.base_types:
            return Model(name, is_exact=True)
        wanted = BASE_TYPES.get(vehicle_class)
        alike = sorted(name for name, base in self.base_types.items() if base == wanted)
        if not alike:
            raise UserError(
                f"SUMO's vehicle type '{kind}' is of the class '{vehicle_class}', which no blueprint shows; give it "
                "the name of a blueprint, such as vehicle.audi.a2, or take it out of the demand"
            )
        stand_ins = [name for name in alike if name in LENGTHS_M] or alike
        return Model(min(stand_ins, key=lambda name: abs(LENGTHS_M.get(name, 4.5) - length_m)), is_exact=False)
