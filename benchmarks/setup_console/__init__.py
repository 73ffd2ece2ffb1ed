"""`aff-runtime setup` and the card, played at a terminal by somebody with displays and manual."""
