"""Tables of a scene file that expand to blocks: walls, buildings, arches, vaults, domes, rubble, meshes, drawings."""
