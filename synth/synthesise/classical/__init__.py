"""Classical compensators: lead-lag."""
