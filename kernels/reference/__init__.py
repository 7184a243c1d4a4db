"""Float64 NumPy twins of the kernels: same file, function name and argument order; slow and obvious."""
