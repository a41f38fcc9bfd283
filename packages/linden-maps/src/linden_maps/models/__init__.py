"""Models of vehicles, people, animals and props, from which the server's asset of actor meshes is made."""
