"""Settings of voxel_grid_filter and ndt_matching that come by topics, as Autoware.AI's user interface sends them."""

from linden_ros2.topic import Message, Topic
from linden_ros2.types import Generation, Types

VOXEL = Topic("/config/voxel_grid_filter", "autoware_config_msgs/msg/ConfigVoxelGridFilter", is_latched=True, depth=1)
MATCHING = Topic("/config/ndt", "autoware_config_msgs/msg/ConfigNDT", is_latched=True, depth=1)
VERSIONS = {
    VOXEL.type: "float32 voxel_leaf_size\nfloat32 measurement_range\n",
    MATCHING.type: "Header header\nint32 init_pos_gnss\nfloat32 x\nfloat32 y\nfloat32 z\nfloat32 roll\nfloat32 pitch\n"
    "float32 yaw\nint32 use_predict_pose\nfloat32 error_threshold\nfloat32 resolution\nfloat32 step_size\n"
    "float32 trans_epsilon\nint32 max_iterations\n",
}
"""The fields of the settings; the nodes have no parameters for them."""
RANGE_M, STEP_M, EPSILON, ITERATIONS = 200.0, 0.1, 0.01, 30  # the nodes' own defaults
LEAF_M, RESOLUTION_M = 2.0, 1.0  # likewise


def types() -> Types:
    """The types of ROS 1, and those of the settings."""
    return Types(Generation.ROS_1, VERSIONS)


def voxel(known: Types, leaf_m: float) -> Message:
    """The width of the cells in which voxel_grid_filter joins a scan's points."""
    return Message(VOXEL, known.message(VOXEL.type, voxel_leaf_size=leaf_m, measurement_range=RANGE_M))


def matching(known: Types, resolution_m: float) -> Message:
    """The width of the cells that ndt_matching makes of the cloud; it must come before the cloud."""
    values = {"resolution": resolution_m, "step_size": STEP_M, "trans_epsilon": EPSILON, "max_iterations": ITERATIONS}
    return Message(MATCHING, known.message(MATCHING.type, init_pos_gnss=1, **values))
