"""Photographs: decoding, and where the tree stands in them."""
