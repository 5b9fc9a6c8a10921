"""One command each: what it reads, plans or judges, writes and says."""
