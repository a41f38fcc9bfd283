"""ROS from the benchmark: messages, frames, bags and DDS, without an installation of ROS.

``frames`` turns CARLA's left-handed values into ROS's; ``types`` makes messages from their definitions. The modules of
sensors and vehicles fill messages, and ``topics`` names the topics. ``bag_file`` writes bags, ``dds`` publishes.
"""
