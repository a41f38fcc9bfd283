"""Making maps: street facts to OpenDRIVE, checks, drawings, point clouds, glTF export. The server does not use it."""
