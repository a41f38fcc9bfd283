"""Sensors: devices, cameras, ray casting, and the runtime that measures in each frame."""
