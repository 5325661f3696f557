"""What the command line runs: the workspace, the tasks of a design, their jobs, and the commands."""
