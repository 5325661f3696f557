"""Estimators as Blocks: GLSDC from phases (`glsdc_estimator`), screening, prediction and dead reckoning."""
