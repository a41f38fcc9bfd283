"""The packages of ROS that are checked before a run."""

from __future__ import annotations

from basu.extras import Extra

CYCLONEDDS = Extra("cyclonedds", 'ROS 2 needs the package cyclonedds; install it with `pip install "basu-ros[ros2]"`')
ROSBAGS = Extra("rosbags", "ROS messages need the package rosbags; install it with `pip install basu-ros`")
