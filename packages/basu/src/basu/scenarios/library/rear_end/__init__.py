"""Scenarios with a vehicle ahead that is slower, brakes or stands: scenario II of the thesis, and more."""
