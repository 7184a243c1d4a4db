"""From a photograph to its alpha matte (Particle Flows, section 4)."""
