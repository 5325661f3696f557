"""The maglev stage as its designs share it: interface, experiments, commutation, fault handling and references."""
