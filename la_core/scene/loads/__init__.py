"""Dead loads and ties as forces on single blocks, and the friction of every joint, from the tables of a scene."""
