"""The shape law: weights are the roll's shape in metres."""
