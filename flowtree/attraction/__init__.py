"""Attractor graphs and their direction fields (Particle Flows, sections 4 and 7)."""
