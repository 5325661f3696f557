"""The parts of the planar positioner that its controllers share: sensing, filters, lifts, allocation, commutation."""
