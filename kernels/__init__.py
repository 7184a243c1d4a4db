"""Warp kernels and wp.funcs, nothing else; installed as flowtree.kernels."""
