"""Forward selection: which effects explain the residual, one after another."""
