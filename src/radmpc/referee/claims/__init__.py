"""What plans state and keep: shapes, means, costs, limits, goals and visits."""
