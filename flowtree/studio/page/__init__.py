"""The studio's page: what a person sees, and how it speaks with the session."""
