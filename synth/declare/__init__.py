"""What a stage is, as data alone: signals, controller, fault campaign, auxiliary Blocks, free parameters."""
