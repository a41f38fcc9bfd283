"""Runs as ROS messages: while they last and from their record, into bags and onto DDS."""
