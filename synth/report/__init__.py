"""Reports: the audit of published figures, derived equations, and one HTML file for each design."""
