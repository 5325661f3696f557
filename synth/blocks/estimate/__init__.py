"""Estimators as Blocks: GLSDC from phases, screening, prediction and dead reckoning."""
