"""Contact points in YADE: their spheres, the faces that these touch, and faces near them that they do not touch."""
