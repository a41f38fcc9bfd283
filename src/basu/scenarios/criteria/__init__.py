"""By what a drive through a scenario is judged: functions of its record, one idea a file."""
