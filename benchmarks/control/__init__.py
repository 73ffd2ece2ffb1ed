"""The control bench: the laws of the product and their rivals on one simulated line."""
