"""Words that every floor shares: signals, events, errors, units, ports."""
