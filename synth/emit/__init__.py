"""Code generation: compiles a Block to C99, a manifest and gains. `pipeline` lists every pass."""
