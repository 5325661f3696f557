"""Studies of the magnetically levitated stage beyond what ships."""
