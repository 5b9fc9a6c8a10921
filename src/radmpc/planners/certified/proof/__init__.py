"""A lower bound on the cost of any plan that the referee would certify, whatever its half-spaces.

With λ the shadow price of risk, V(S, λ) the least of cost + λ · risk over a set S of vehicles in
the relaxation of `radmpc.program.relaxed`, and sets that part the fleet,

    cost of any certified plan >= Σ V(S, λ) − λ Δ,

because leaving out what happens between sets leaves out risk only. Any λ >= 0 and any parting will
do; those of the plan at hand are near the best.
"""
