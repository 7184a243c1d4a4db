"""What flowtree reaches, measured: ``python -m benchmarks`` lists the programs here."""
