"""Campaigns: one file states a question, jobs are made of it, workers drive them, a table holds a row for each drive.

`settings` reads the file, `plan` makes jobs of it, `player` drives one, `columns` and `drive_table` hold the rows,
`records` keeps folders of telling drives, `command` runs it all. `statistics` and `report` say what may be concluded.
"""
