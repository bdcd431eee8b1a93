"""The frame of a run, and contact points in it: their spheres, the faces that these touch, and faces near them that they do not touch."""
