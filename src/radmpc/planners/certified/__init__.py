"""The certified planner: sets planned exactly at one price of risk, joined, and judged.

All files share the Lagrangian of the chance-constrained program over the whole fleet,

    minimize  Σ over sets of  (effort + λ · risk / unit),

which decomposes into one problem per set at a Lagrange multiplier λ common to all, the unit price
of risk (`fleet` defines the unit); the referee says which sets may stay apart, and λ is chosen so
that the joint risk is just within Δ.
"""
