"""What a controller does about faults: redundant sensors, isolation, landing, braking, excitation test."""
