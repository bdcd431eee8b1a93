"""From the tables of a scene: dead loads and ties as forces on blocks, motions of supports, tilt, and the friction of every joint."""
