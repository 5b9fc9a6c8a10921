"""What measurements tell under way: of states, of covariances, and of a model that is wrong."""
