"""Integrity of three and four sensors over unknown fields and faults, layouts, six degrees of freedom."""
