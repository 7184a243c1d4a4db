"""From traces to branches with radii, and twigs (Particle Flows, section 8)."""
