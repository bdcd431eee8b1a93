"""The frame of a run, and its contact points: their spheres, the faces in contact, and other faces near the spheres."""
