"""What precedes the search over faces, and what follows it."""
