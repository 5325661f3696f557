"""Structure of models: poles and zeros, relative degree, Gramians, minimal realisations, parity relations."""
