"""What the engine and the node reach, beside what others do on the same scenes: `make bench`."""
