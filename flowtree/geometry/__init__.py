"""Pure mathematics without a tree word in it: frames, projections, polylines, sampling."""
