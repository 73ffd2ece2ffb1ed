"""Measurements that stand outside the product and may import both of its halves."""
