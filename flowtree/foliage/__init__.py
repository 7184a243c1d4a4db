"""Leaves: shape, texture, place, colour (Particle Flows, section 8)."""
