"""From a skeleton to the surface of its wood (Particle Flows, section 8)."""
