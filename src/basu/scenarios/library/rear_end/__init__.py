"""Who is ahead is slower, brakes or stands: scenario II of the thesis, and more."""
