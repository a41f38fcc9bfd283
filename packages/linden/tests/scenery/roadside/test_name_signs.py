"""Claims about the meshes of street-name signs."""

import numpy as np
import pytest

from linden.maps.facts import derive
from linden.maps.records import ADVANCE, BLADE_LETTER_M, STREET_NAME_SIGN
from linden.maps.standing import BLADE_HALF_HEIGHT_M, LONGEST_NAME, MOST_BLADES, blade_half_length_m
from linden.protocol.values.enums import SemanticTag
from linden.scenery.map_mesh import things
from linden.scenery.patches import PatchFrames
from linden.scenery.roadside.name_signs import blades_with_names, capitals
from linden.scenery.roadside.signal_posts import KNOWN_LETTERS, letters
from linden.scenery.scene.mapped import mapped
from linden.scenery.scene.objects import ObjectKind
from opendrive_texts import street_through_junction

POST = "".join(
    f'<cornerLocal u="{u}" v="{v}" z="0" height="2.8"/>'
    for u, v in ((-0.03, -0.03), (0.03, -0.03), (0.03, 0.03), (-0.03, 0.03))
)


def sign(*blades: str) -> str:
    """An object that stands beside the first road of the street."""
    notes = "".join(f'<userData code="streetName" value="{blade}"/>' for blade in blades)
    place = 'id="1" type="pole" name="StreetNameSign" s="10" t="7" hdg="0"'
    return f"<object {place}><outline>{POST}</outline>{notes}</object>"


def standing(*blades: str):
    return derive(street_through_junction(objects=sign(*blades))).standing


def test_a_sign_is_a_post_with_a_blade_for_each_street() -> None:
    (found,) = standing("0.000 Main St", "1.571 2nd Ave")
    post, *blades = found.boxes
    assert (found.kind, found.name) == (STREET_NAME_SIGN, "Main St / 2nd Ave")
    assert post.half_z_m == pytest.approx(1.4)
    assert [blade.half_x_m for blade in blades] == [blade_half_length_m("Main St"), blade_half_length_m("2nd Ave")]
    tops = [blade.z_m + blade.half_z_m - found.z_m for blade in blades]
    np.testing.assert_allclose(tops, [2.8, 2.8 - 2 * BLADE_HALF_HEIGHT_M])
    assert abs(np.cos(blades[0].yaw_rad - blades[1].yaw_rad)) == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("blade", ["Main St", "nan Main St", "0.0 ", "inf X"])
def test_a_blade_without_a_turn_or_a_name_is_none(blade: str) -> None:
    assert standing(blade) == ()


def test_names_and_blades_are_bounded() -> None:
    (found,) = standing(*(f"0.{n} {'x' * 100}" for n in range(9)))
    assert len(found.boxes) == 1 + MOST_BLADES
    assert found.boxes[1].half_x_m == pytest.approx(blade_half_length_m("x" * LONGEST_NAME))


def test_clients_see_a_pole_and_traffic_signs_with_the_names() -> None:
    scene = mapped(standing("0.000 Main St", "1.571 2nd Ave"))
    assert scene.thing_names == ("StreetNameSign_0_MainSt2ndAve",)
    assert scene.boxes["tag"].tolist() == [SemanticTag.POLES, *[SemanticTag.TRAFFIC_SIGNS] * 2]


def test_what_is_seen_lies_in_the_boxes() -> None:
    facts = derive(street_through_junction(objects=sign("0.000 Cleveland Ave", "0.5 E 17th Ave")))
    scene = mapped(facts.standing)
    assert (scene.things["kind"] == ObjectKind.STREET_NAME_SIGN).all()
    mesh = things(facts, scene)
    for row, box in enumerate(scene.boxes):
        corners = mesh.vertices_m[mesh.triangles[mesh.faces["object"] == row].ravel()] - box["centre"]
        cosine, sine = np.cos(box["yaw_rad"]), np.sin(box["yaw_rad"])
        along = np.abs(corners @ np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]]))
        assert len(corners) > 20
        above = corners[:, 2] > -box["half"][2]  # a post is rooted in the ground
        assert (along[above] <= box["half"] + 0.004).all()


def test_every_capital_and_digit_can_be_drawn_and_fits_its_advance() -> None:
    assert set("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789 ") <= KNOWN_LETTERS
    for letter in sorted(KNOWN_LETTERS - {" "}):
        strokes = np.concatenate(letters(letter, BLADE_LETTER_M))
        assert np.abs(strokes[:, 0]).max() <= 0.5 * ADVANCE * BLADE_LETTER_M + 0.001
        assert np.abs(strokes[:, 1]).max() <= 0.5 * BLADE_LETTER_M + 0.02


def test_names_of_other_alphabets_lose_what_cannot_be_drawn() -> None:
    assert capitals("Rue de l'Été") == "RUE DE L'ETE"
    assert capitals("北 St") == "  ST"


def test_both_faces_of_a_blade_can_be_read_and_an_empty_name_draws_none() -> None:
    frames = PatchFrames(np.zeros((1, 3)), np.zeros(1))
    half = np.array([[0.5, 0.006, 0.075]])
    plain = blades_with_names(frames, half, np.zeros(1, np.int32), ["北"])
    written = blades_with_names(frames, half, np.zeros(1, np.int32), ["L"])
    white = written.vertices_m[written.triangles[len(plain.triangles) :].ravel()]
    assert len(plain.triangles) == 12
    for side in (1.0, -1.0):
        face = white[np.sign(white[:, 1]) == side]
        foot = face[face[:, 2] < -0.03]
        reader_s_right = side  # of the middle: the foot of an L points to the right
        assert foot[:, 0].max() * reader_s_right > 0.0 or foot[:, 0].min() * reader_s_right > 0.0
        stem = face[face[:, 2] > 0.03]
        assert (stem[:, 0] * reader_s_right < 0.0).all()
