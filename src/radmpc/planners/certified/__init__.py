"""The certified planner: sets planned exactly at one price of risk, joined, and judged.

All files share the Lagrangian of the chance-constrained program over the whole fleet,

    minimize  Σ over sets of  (effort + λ · risk / Δ),

which falls apart into one problem per set at a multiplier λ common to all; the referee says which
sets may stay apart, and λ is chosen so that the joint risk is just within Δ.
"""
