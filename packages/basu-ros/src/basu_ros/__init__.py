"""ROS from the benchmark: messages, frames, bags and DDS without ROS, and ROS 1 where rospy is installed.

``topics`` names the topics of a vehicle, and the modules of vehicles and Autoware fill messages. ``bag_file`` writes
bags. ``dds`` and ``ros1`` publish. Types, frames, sensors' messages and nodes on DDS are those of `linden_ros2`.
"""
