"""Four sensors with the amplitude estimated, integrity monitoring, and exclusion of a faulty sensor."""
