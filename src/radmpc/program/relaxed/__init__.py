"""The relaxation whose optimum bounds the cost of every plan that the referee would certify.

A plan is certified if charges for all encounters sum to Δ at most, and a charge is never below the
probability of that collision. That probability is at least what a disc within the hazard, touching
its outline where the mean is nearest, collects: a function of the distance alone, in standard
deviations. All points that far away form a *level curve* around the hazard, convex, and from each
the distance grows fastest along its own gradient.

Between two gradient rays the distance is at most the affine function that passes through the two
points and grows as fast as the slower ray: one *cone* of directions becomes one chance row. All
cones around a hazard together are the alternatives of an avoidance, so that the relaxation is a
`DisjunctiveProgram`, and its searches serve as they are. Half-spaces of any direction obey one of
its cones; nothing in it depends on faces that were chosen beforehand.
"""
