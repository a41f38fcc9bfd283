"""Sensor models: each turns the state of one moment into a measurement."""
