"""Agents that are ROS 2 software in other processes: CARLA's and Autoware's topics, in lock-step with the run."""
