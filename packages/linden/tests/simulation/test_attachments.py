"""Claims about where spring arms hold what is attached to them."""

import numpy as np
import pytest

from linden.errors import Refusal
from linden.geometry import rotation_matrix
from linden.protocol.values.enums import AttachmentType
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.simulation.attachments import hung

GHOST = AttachmentType.SPRING_ARM_GHOST


@pytest.mark.parametrize(
    "place", [Vector3D(-5.0, 0.0, 2.8), Vector3D(4.5, 1.0, 1.2), Vector3D(0.0, 0.0, 6.0), Vector3D(-0.0, 3.0, 0.0)]
)
def test_a_camera_on_an_arm_looks_at_the_parents_origin(place: Vector3D) -> None:
    held = hung(Transform(place, Rotation()), GHOST)
    assert held.location == pytest.approx(place)
    forward = rotation_matrix(held.rotation)[:, 0]
    assert forward == pytest.approx(-np.asarray(place) / np.linalg.norm(place), abs=1e-12)


def test_its_own_pitch_is_added_to_the_arms() -> None:
    level = hung(Transform(Vector3D(-5.0, 0.0, 2.8), Rotation()), GHOST)
    raised = hung(Transform(Vector3D(-5.0, 0.0, 2.8), Rotation(8.0, 0.0, 0.0)), GHOST)
    assert raised.rotation.pitch - level.rotation.pitch == pytest.approx(8.0)


def test_an_arm_that_minds_the_ground_is_held_higher() -> None:
    pose = Transform(Vector3D(-5.0, 0.0, 2.8), Rotation())
    minding, ghost = hung(pose, AttachmentType.SPRING_ARM), hung(pose, GHOST)
    assert minding.location.z - ghost.location.z == pytest.approx(0.3)
    assert minding.rotation == ghost.rotation


def test_an_arm_of_no_length_looks_ahead() -> None:
    assert hung(Transform(), GHOST) == Transform()


def test_what_is_attached_rigidly_stays_as_it_is() -> None:
    pose = Transform(Vector3D(1.0, 2.0, 3.0), Rotation(4.0, 5.0, 6.0))
    assert hung(pose, AttachmentType.RIGID) == pose


def test_a_kind_that_does_not_exist_is_refused() -> None:
    with pytest.raises(Refusal, match=r"7 is no kind of attachment; there are 0 \(RIGID\)"):
        hung(Transform(), 7)
