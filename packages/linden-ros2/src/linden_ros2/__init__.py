"""ROS 2 without ROS: messages from their definitions, CARLA's frames in ROS's, nodes on DDS; and a server's publisher.

`attached` belongs to the server. The other modules know no server, so that `basu_ros` uses them too.
"""
