"""Branch and bound over alternatives with the risk as a variable, at a Lagrange multiplier.

All files share one objective, the Lagrangian of the chance-constrained program,

    minimize  cost(z) + λ · risk(z) / Δ,

with λ the Lagrange multiplier of the risk bound and risk(z) the sum, over all avoidances, of the
risk of the cheapest alternative.
"""
