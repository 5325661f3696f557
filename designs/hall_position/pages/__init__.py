"""Blocks of the report, by their names in report.md."""
