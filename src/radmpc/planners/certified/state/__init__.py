"""How far the search for a fleet's plan has come, and what it proves; no phase changes it."""
