"""Particle tracing from the crown to the foot (Particle Flows, section 6)."""
