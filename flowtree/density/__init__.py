"""From mattes to a voxel volume of optical density (Particle Flows, section 5)."""
