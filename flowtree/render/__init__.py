"""Pictures and masks of a finished tree."""
