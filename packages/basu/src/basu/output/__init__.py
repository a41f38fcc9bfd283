"""Everything that a user looks at: reports, the HUD window, Rerun, the progress bar."""
