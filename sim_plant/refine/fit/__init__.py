"""The weighted least-squares objective and its minimum."""
