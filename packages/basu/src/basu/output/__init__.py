"""Everything that a user looks at: reports, charts, the progress bar."""
