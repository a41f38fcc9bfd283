"""A node of ROS 1 without any of BASU's code, run by the system's Python: it hears a vehicle and commands it once.

The type of the command is made of the definition in the first line of standard input, as rospy's tools do it.
"""

import json
import sys
import threading

import genpy.dynamic
import rospy
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import PointCloud2
from tf2_msgs.msg import TFMessage

COMMAND = "carla_msgs/CarlaEgoVehicleControl"
TOPICS = {"clock": Clock, "tf_static": TFMessage, "carla/hero/odometry": Odometry, "carla/hero/LIDAR": PointCloud2}


def tell(line):
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


def main():
    definition = json.loads(sys.stdin.readline())
    command = genpy.dynamic.generate_dynamic(COMMAND, definition)[COMMAND]
    rospy.init_node("peer", disable_signals=True)
    heard, complete = {}, threading.Event()

    def hear(message, name):
        heard[name] = message
        if len(heard) == len(TOPICS):
            complete.set()

    for name, kind in TOPICS.items():
        rospy.Subscriber("/" + name, kind, hear, name)
    publisher = rospy.Publisher("/carla/hero/vehicle_control_cmd", command, queue_size=1)
    tell("ready")
    complete.wait(60.0)
    odometry, cloud = heard["carla/hero/odometry"], heard["carla/hero/LIDAR"]
    place = odometry.pose.pose.position
    found = {
        "clock": heard["clock"].clock.to_sec(),
        "frames": [each.child_frame_id for each in heard["tf_static"].transforms],
        "frame": odometry.header.frame_id,
        "place": [place.x, place.y],
        "points": cloud.width,
        "fields": [field.name for field in cloud.fields],
        "bytes": list(cloud.data[:8]),
    }
    tell(json.dumps(found))
    sys.stdin.readline()
    while not publisher.get_num_connections():  # rospy drops a message while the subscriber's connection is being made
        threading.Event().wait(0.01)
    message = command(throttle=0.5, steer=-0.25, gear=2, reverse=True)
    message.header.stamp.secs = 3
    publisher.publish(message)
    sys.stdin.readline()
    rospy.signal_shutdown("done")


if __name__ == "__main__":
    main()
