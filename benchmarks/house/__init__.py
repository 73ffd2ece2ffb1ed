"""The shape of the code in figures: rooms, floors, import arrows, longest functions."""
