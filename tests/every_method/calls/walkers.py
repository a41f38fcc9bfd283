"""carla.Walker, its bones, and the controller that leads it."""

import carla

from every_method.call import Call
from every_method.calls.actors import BONE, after
from every_method.entries import comparisons, fields
from every_method.stage import Stage


def raised_arm() -> carla.bone_transform:
    """A bone turned by hand."""
    bone = carla.bone_transform()
    bone.name = "crl_arm__L"
    bone.transform = carla.Transform(rotation=carla.Rotation(pitch=90.0))
    return bone


def pose() -> carla.WalkerBoneControlIn:
    """A pose of one bone."""
    control = carla.WalkerBoneControlIn()
    control.bone_transforms = [raised_arm()]
    return control


def bone(stage: Stage) -> carla.bone_transform_out:
    """One of a walker's bones."""
    return next(found for found in stage.walker.get_bones().bone_transforms if found.name == BONE)


def empty_bone() -> carla.bone_transform_out:
    """A bone as a script makes it."""
    return carla.bone_transform_out()


def named_bone() -> carla.bone_transform_out:
    """Another one."""
    found = carla.bone_transform_out()
    found.name = BONE
    return found


def controller(stage: Stage) -> carla.WalkerAIController:
    """Who leads the walker."""
    return stage.once("controller", lambda: stage.sensor("controller.ai.walker", stage.walker))


CALLS: dict[str, Call] = {
    "Walker.__str__": lambda s: "walker.pedestrian.0001" in str(s.walker),
    "Walker.apply_control": lambda s: after(
        s,
        lambda: s.walker.apply_control(carla.WalkerControl(carla.Vector3D(x=1.0), 1.0)),
        lambda: s.walker.get_velocity().length() > 0.5,
    ),
    "Walker.get_control": lambda s: s.walker.get_control().speed == 1.0,
    "Walker.get_bones": lambda s: len(s.walker.get_bones().bone_transforms) > 10,
    "Walker.set_bones": lambda s: s.walker.set_bones(pose()),
    "Walker.blend_pose": lambda s: s.walker.blend_pose(0.5),
    "Walker.show_pose": lambda s: s.walker.show_pose(),
    "Walker.hide_pose": lambda s: s.walker.hide_pose(),
    "Walker.get_pose_from_animation": lambda s: s.walker.get_pose_from_animation(),
    "WalkerBoneControlIn.__init__": lambda _: len(carla.WalkerBoneControlIn().bone_transforms) == 0,
    "WalkerBoneControlIn.bone_transforms": lambda _: len(pose().bone_transforms) == 1,
    "WalkerBoneControlIn.__str__": lambda _: len(str(pose())) > 0,
    "WalkerBoneControlOut.__init__": lambda _: isinstance(carla.WalkerBoneControlOut(), carla.WalkerBoneControlOut),
    "WalkerBoneControlOut.bone_transforms": lambda s: len(s.walker.get_bones().bone_transforms) > 10,
    "WalkerBoneControlOut.__str__": lambda s: len(str(s.walker.get_bones())) > 0,
    "bone_transform.__init__": lambda _: carla.bone_transform().name == "",
    **fields("bone_transform", lambda _: raised_arm(), name="crl_arm__L", transform=lambda p: p.rotation.pitch == 90.0),
    "bone_transform.__str__": lambda _: len(str(raised_arm())) > 0,
    "bone_transform_out.__init__": lambda _: carla.bone_transform_out().name == "",
    **comparisons("bone_transform_out", empty_bone, named_bone),
    **fields(
        "bone_transform_out",
        bone,
        name=BONE,
        world=lambda found: isinstance(found, carla.Transform),
        component=lambda found: isinstance(found, carla.Transform),
        relative=lambda found: isinstance(found, carla.Transform),
    ),
    "WalkerAIController.__str__": lambda s: "controller.ai.walker" in str(controller(s)),
    "WalkerAIController.start": lambda s: controller(s).start(),
    "WalkerAIController.go_to_location": lambda s: controller(s).go_to_location(
        s.world.get_random_location_from_navigation()
    ),
    "WalkerAIController.set_max_speed": lambda s: controller(s).set_max_speed(1.4),
    "WalkerAIController.stop": lambda s: controller(s).stop(),
}
