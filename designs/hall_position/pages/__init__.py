"""What the report shows, as blocks by the names that report.md places them by."""
