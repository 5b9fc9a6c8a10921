"""Where the risk goes: the ledger as bars and maps, and risk over time."""
