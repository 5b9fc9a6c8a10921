"""An upper bound on the probability of any collision of a plan: the certificate."""
