"""Props of the street, each about as large as (length, width, height) in m and standing at the origin."""

from collections.abc import Callable

from linden.scenery.mesh import Material, Mesh
from linden_maps.models.fittings import hoop
from linden_maps.models.solids import (
    BLACK,
    GLASS,
    STEEL,
    FaceLook,
    box,
    lathe,
    moved,
    prism,
    rod,
    stretched,
    tube,
    wedge,
)

Model = Callable[[float, float, float], list[Mesh]]
Colour = tuple[int, int, int]

_WHITE = FaceLook(Material.SIGN_FACE, (234, 234, 228))
_WOOD = FaceLook(Material.WOOD, (126, 88, 56))
_STONE = FaceLook(Material.CONCRETE, (160, 158, 152))
_IRON = FaceLook(Material.METAL, (58, 60, 62))
_SCREEN = FaceLook(Material.GLASS, (60, 90, 120))


def bollard(length: float, width: float, height: float) -> list[Mesh]:
    """Return an iron post on a foot."""
    r = 0.25 * (length + width)
    share = (0.0, 0.06, 0.1, 0.8, 0.86, 0.95, 1.0)
    return [lathe([height * s for s in share], [r * k for k in (1.0, 1.0, 0.4, 0.4, 0.62, 0.5, 0.1)], 10, _IRON)]


def chain_barrier(length: float, width: float, height: float) -> list[Mesh]:
    """Return two posts with a chain between."""
    x = 0.5 * (length - width)
    sag = [(x * (-1.0 + 0.25 * n), 0.0, height * (0.8 - 0.3 * (1.0 - (0.25 * n - 1.0) ** 2))) for n in range(9)]
    posts = [moved(mesh, (s * x, 0.0, 0.0)) for s in (-1.0, 1.0) for mesh in bollard(width, width, height)]
    return [*posts, tube(sag, [0.02] * len(sag), 5, _IRON)]


def bench(*, back: bool) -> Model:
    """Return the model of a bench of boards on iron legs."""

    def make(length: float, width: float, height: float) -> list[Mesh]:
        x, y = 0.5 * length, 0.5 * width
        seat = 0.46 * height if back else height
        made = [
            box((-x, y - 0.12 - n * 0.13, seat - 0.04), (x, y - 0.005 - n * 0.13, seat), _WOOD)
            for n in range(max(2, round(width * (0.75 if back else 1.0) / 0.13)))
        ]
        for at in (-0.8 * x, 0.8 * x):
            made.append(box((at - 0.03, -0.9 * y, 0.0), (at + 0.03, -0.9 * y + 0.06, seat), _IRON))
            made.append(box((at - 0.03, 0.8 * y, 0.0), (at + 0.03, 0.8 * y + 0.06, seat), _IRON))
            if back:
                made.append(box((at - 0.02, -0.95 * y, seat - 0.03), (at + 0.02, -0.85 * y, height), _IRON))
        if back:
            made += [
                box((-x, -0.85 * y, z), (x, -0.75 * y, z + 0.12 * height), _WOOD)
                for z in (0.62 * height, 0.78 * height)
            ]
            made.append(box((-x, -y, 0.92 * height), (x, -0.75 * y, height), _WOOD))
        return made

    return make


def wheeled_bin(colour: Colour) -> Model:
    """Return the model of a household bin on two wheels with a lid."""

    def make(length: float, width: float, height: float) -> list[Mesh]:
        x, y, look = 0.5 * length, 0.5 * width, FaceLook(Material.PLAIN, colour)
        lid = box((-x, -y, 0.9 * height), (x, y, height), FaceLook(Material.PLAIN, (30, 34, 32)))
        body = wedge((-0.72 * x, -0.9 * y, 0.06), (0.8 * x, 0.9 * y, 0.9 * height), look, top_x=(-0.95 * x, 0.95 * x))
        wheels = [moved(hoop(0.08, 0.025, BLACK), (-0.8 * x, s * 0.7 * y, 0.105)) for s in (-1.0, 1.0)]
        return [lid, body, *wheels]

    return make


def litter_bin(length: float, width: float, height: float) -> list[Mesh]:
    """Return a round bin with a dark mouth."""
    share, radii = (0.0, 0.04, 0.72, 0.74, 0.84, 0.86, 0.96, 1.0), (0.9, 0.92, 1.0, 0.86, 0.86, 1.0, 0.9, 0.4)
    body = FaceLook(Material.METAL, (70, 84, 78))
    looks = [_IRON, body, body, BLACK, body, body, _IRON]
    unit = lathe([height * s for s in share], list(radii), 14, looks)
    return [stretched(unit, (0.5 * length, 0.5 * width, 1.0))]


def container(colour: Colour) -> Model:
    """Return the model of a large container with a sloping lid."""

    def make(length: float, width: float, height: float) -> list[Mesh]:
        x, y, look = 0.5 * length, 0.5 * width, FaceLook(Material.METAL, colour)
        lid = FaceLook(Material.PLAIN, (46, 48, 50))
        ribs = [box((s * x - 0.03, -y, 0.1), (s * x + 0.03, y, 0.75 * height), look) for s in (-0.6, 0.0, 0.6)]
        feet = [
            moved(lathe([0.0, 0.1], [0.06, 0.06], 8, BLACK), (s * 0.85 * x, t * 0.8 * y, 0.0))
            for s in (-1.0, 1.0)
            for t in (-1.0, 1.0)
        ]
        body = box((-x, -0.97 * y, 0.08), (x, 0.97 * y, 0.78 * height), look)
        roof = prism(
            [(-y, 0.78 * height), (y, 0.78 * height), (0.8 * y, 0.88 * height), (-0.6 * y, height), (-y, height)],
            -x,
            x,
            lid,
            along=0,
        )
        return [body, roof, *ribs, *feet]

    return make


def machine(colour: Colour) -> Model:
    """Return the model of a cabinet with a lit screen: vending machine, cash dispenser."""

    def make(length: float, width: float, height: float) -> list[Mesh]:
        x, y, look = 0.5 * length, 0.5 * width, FaceLook(Material.METAL, colour)
        return [
            box((-x, -y, 0.0), (0.97 * x, y, height), look),
            box((0.9 * x, -0.8 * y, 0.45 * height), (x, 0.45 * y, 0.9 * height), _SCREEN),
            box((0.9 * x, 0.52 * y, 0.5 * height), (x, 0.85 * y, 0.75 * height), STEEL),
            box((0.9 * x, -0.7 * y, 0.12 * height), (0.985 * x, 0.5 * y, 0.28 * height), BLACK),
        ]

    return make


def mailbox(length: float, width: float, height: float) -> list[Mesh]:
    """Return a letter box with a round top on four legs."""
    x, y, low = 0.5 * length, 0.5 * width, 0.18 * height
    blue = FaceLook(Material.METAL, (28, 62, 128))
    arch = [
        (-y, low),
        (y, low),
        (y, 0.8 * height),
        (0.7 * y, 0.93 * height),
        (0.25 * y, height),
        (-0.25 * y, height),
        (-0.7 * y, 0.93 * height),
        (-y, 0.8 * height),
    ]
    outline = [arch[k] for k in (1, 2, 3, 4, 5, 6, 7, 0)]
    legs = [
        box((s * 0.85 * x - 0.03, t * 0.8 * y - 0.03, 0.0), (s * 0.85 * x + 0.03, t * 0.8 * y + 0.03, low), BLACK)
        for s in (-1.0, 1.0)
        for t in (-1.0, 1.0)
    ]
    return [
        prism(outline, -x, 0.98 * x, blue, along=0),
        box((0.9 * x, -0.7 * y, 0.74 * height), (x, 0.7 * y, 0.79 * height), BLACK),
        *legs,
    ]


def shelter(*, along_x: bool) -> Model:
    """Return the model of a bus shelter of glass with a bench and a roof, open in front."""

    def make(length: float, width: float, height: float) -> list[Mesh]:
        long_m, deep_m = (length, width) if along_x else (width, length)
        x, y = 0.5 * long_m, 0.5 * deep_m
        made = [box((-x, -y, 0.93 * height), (x, y, height), _IRON)]
        made += [
            box((s * 0.93 * x - 0.04, t * y - 0.04, 0.0), (s * 0.93 * x + 0.04, t * y + 0.04, 0.94 * height), _IRON)
            for s in (-1.0, 1.0)
            for t in (-0.85, 0.5)
        ]
        made.append(box((-0.92 * x, -0.87 * y, 0.15), (0.92 * x, -0.84 * y, 0.88 * height), GLASS))
        made += [
            box((s * 0.93 * x - 0.012, -0.82 * y, 0.15), (s * 0.93 * x + 0.012, 0.45 * y, 0.88 * height), GLASS)
            for s in (-1.0, 1.0)
        ]
        made += [
            box((-0.6 * x, -0.75 * y, 0.42), (0.6 * x, -0.35 * y, 0.47), _WOOD),
            box((-0.5 * x, -0.6 * y, 0.0), (-0.45 * x, -0.5 * y, 0.42), _IRON),
            box((0.45 * x, -0.6 * y, 0.0), (0.5 * x, -0.5 * y, 0.42), _IRON),
        ]
        made.append(box((-0.98 * x, -y, 0.0), (0.98 * x, 0.95 * y, 0.04), _STONE))
        if along_x:
            return made
        return [mesh._replace(vertices_m=mesh.vertices_m[:, [1, 0, 2]] * (1.0, -1.0, 1.0)) for mesh in made]

    return make


def kiosk(length: float, width: float, height: float) -> list[Mesh]:
    """Return a kiosk with a hatch and an awning."""
    x, y, wall = 0.5 * length, 0.5 * width, 0.72 * height
    green = FaceLook(Material.SIDING, (36, 84, 66))
    roof = lathe([wall, wall + 0.1 * height, height], [1.0, 0.75, 0.06], 8, FaceLook(Material.METAL, (52, 60, 58)))
    return [
        box((-0.85 * x, -0.85 * y, 0.0), (0.85 * x, 0.85 * y, wall), green),
        box((0.8 * x, -0.65 * y, 0.42 * wall), (0.88 * x, 0.65 * y, 0.85 * wall), GLASS),
        box((0.8 * x, -0.75 * y, 0.38 * wall), (x, 0.75 * y, 0.42 * wall), _WOOD),
        stretched(roof, (x, y, 1.0)),
    ]


def food_cart(length: float, width: float, height: float) -> list[Mesh]:
    """Return a food cart: a counter on wheels under a striped roof."""
    x, y = 0.5 * length, 0.5 * width
    made = [box((-0.6 * x, -0.8 * y, 0.35), (0.6 * x, 0.8 * y, 0.36 * height), FaceLook(Material.PLAIN, (200, 60, 50)))]
    made.append(box((-0.7 * x, -0.85 * y, 0.36 * height), (0.75 * x, 0.85 * y, 0.39 * height), STEEL))
    made += [
        rod((s * 0.55 * x, t * 0.75 * y, 0.38 * height), (s * 0.55 * x, t * 0.75 * y, 0.8 * height), 0.04, STEEL)
        for s in (-1.0, 1.0)
        for t in (-1.0, 1.0)
    ]
    stripes = 10
    for n in range(stripes):
        start = -y + n * width / stripes
        look = _WHITE if n % 2 else FaceLook(Material.CLOTH, (200, 50, 40))
        made.append(
            prism(
                [(-x, 0.78 * height), (x, 0.78 * height), (0.25 * x, height), (-0.25 * x, height)],
                start,
                start + width / stripes,
                look,
                along=1,
            )
        )
    wheel = hoop(0.3, 0.05, BLACK)
    return [*made, *(moved(wheel, (s * 0.55 * x, t * 0.82 * y, 0.35)) for s in (-1.0, 1.0) for t in (-1.0, 1.0))]


def drinking_fountain(length: float, width: float, height: float) -> list[Mesh]:
    """Return a drinking fountain: a post with a basin."""
    post = box((-0.4 * length, -0.5 * width, 0.0), (0.4 * length, -0.15 * width, height), _IRON)
    basin = box((-0.5 * length, -0.2 * width, 0.5 * height), (0.5 * length, 0.5 * width, 0.62 * height), _STONE)
    return [post, basin, rod((0.0, -0.2 * width, 0.75 * height), (0.0, 0.1 * width, 0.75 * height), 0.02, STEEL)]
