"""An exported line beside the kernel: size, speed, difference per effect."""
