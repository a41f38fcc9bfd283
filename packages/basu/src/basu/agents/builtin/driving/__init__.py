"""Motion planning and control without carla: manner, path, speed profile, task, planner, controllers, drivers."""
