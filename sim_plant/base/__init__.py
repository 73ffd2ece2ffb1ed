"""Words that every floor of the plant shares."""
