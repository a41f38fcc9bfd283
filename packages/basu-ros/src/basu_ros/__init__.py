"""ROS from the benchmark: messages, frames, bags and DDS without ROS, and ROS 1 where rospy is installed.

``frames`` turns CARLA's left-handed values into ROS's; ``types`` makes messages from their definitions. The modules of
sensors and vehicles fill messages, and ``topics`` names the topics. ``bag_file`` writes bags. ``dds`` and ``ros1``
publish.

The import raises UserError where rosbags is not installed: every module of this package needs its types.
"""

from basu.extras import require
from basu_ros.extras import ROSBAGS

require(ROSBAGS)
