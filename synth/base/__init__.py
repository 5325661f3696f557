"""What knows no control: the store, caching by content, jobs on several cores, progress, names loaded when used."""
