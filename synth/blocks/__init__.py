"""Blocks: guard and safe output, linear models, derivative filter, internal-model regulator, GLSDC, control axes."""
