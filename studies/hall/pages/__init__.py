"""Pages of the studies: accuracy, integrity, loops, six degrees of freedom."""
