"""Programs that others would write for the workload, each with the means of one library."""
