"""The parts of ``python -m benchmarks fidelity``: what each asks and how it is measured, one file a part."""
