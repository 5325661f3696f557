"""Studies of hall_position beyond the paper and beyond its verification: `python -m studies.hall`."""
