"""OpenDRIVE road networks in double precision: geometry, lanes, links, places on them and paths between them."""
