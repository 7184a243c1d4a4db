"""The tests: mirrors flowtree/ and kernels/."""
