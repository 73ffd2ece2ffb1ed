"""CANopen: nodes by EDS."""
