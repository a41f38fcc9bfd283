"""What a report draws: a record's signals, thinned out, as charts, a timeline and a map, in HTML and inline SVG."""
