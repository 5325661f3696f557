"""Classical compensators: lead-lag, and its design for a crossover frequency and phase margin."""
