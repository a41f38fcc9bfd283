"""Others who change into the ego's lane, or drift into it."""
