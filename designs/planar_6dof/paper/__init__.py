"""The audit of Yu and Kim's paper, Y, which both planar controllers follow."""
