"""Between processes: packets, requests, and the folder where they meet."""
