"""The program between expressions and C: its nodes, their operations, words and layout, and its NumPy evaluation."""
