"""Variance components of several outputs by restricted maximum likelihood (REML), and their effect on the confidence.

y_j = Phi_j theta + e_j, j = 1..p, N rows each, e_j of standard deviation s_j. U_j (N, k) are the rows of output j in an
orthonormal basis of the range of Phi_j / s_j, stacked, G_j = U_j' U_j, and the sum of G_j is I. The residuals of output
j have f_j degrees of freedom, by restricted maximum likelihood, and log s_j^2 has the covariance W:

    s_j^2 = |e_j|^2 / f_j,     f_j = N - tr G_j,     W = 2 T^-1,     T_ij = (f_i - tr G_i) d_ij + tr(G_i G_j)

Estimated weights increase the variance of the estimate above R R' for known ones, d theta = R d(U'y):

    cov theta = R (I + 2 sum_ij W_ij (d_ij G_i - G_i G_j)) R'          Kenward and Roger 1997
    freedom of theta_i = 2 / (a' W a),     a_j = (R G_j R')_ii / (R R')_ii       Satterthwaite 1946

With parameters of groups of rows, [U, Q] takes the place of U (`bordered`). One output has N - k degrees of freedom. N
must exceed the number of parameters of each output: otherwise s_j -> 0, with a fit through all rows of output j, has
the largest likelihood.
"""

from dataclasses import dataclass

import numpy as np

from synth.statespace import Array


@dataclass(frozen=True, eq=False)
class Confidence:
    """The covariance (k, k) of an estimate and the degrees of freedom (k,) of each of its variances."""

    covariance: Array
    degrees_of_freedom: Array


def deviations(e: Array, U: Array, Q: Array) -> Array:
    """Return the standard deviations (p,) of noise with the residuals e (N, p) of a fit.

    U (N, p, k) and Q (s, L, p, f) are its bases.
    """
    size = np.abs(e).max(axis=0)
    size = np.where(size > 0, size, 1.0)
    freedom = len(e) - (U**2).sum(axis=(0, 2)) - (Q**2).sum(axis=(0, 1, 3))
    return size * np.sqrt(((e / size) ** 2).sum(axis=0) / freedom)


def confidence(U: Array, Q: Array, root: Array) -> Confidence:
    """Return the confidence of theta = root U'y + const, y (N, p) divided by its standard deviations."""
    G, group_gram = np.einsum("npi,npj->pij", U, U), np.einsum("slpf,slpg->psfg", Q, Q)
    between = np.einsum("slpk,slpf->pskf", U.reshape(*Q.shape[:3], U.shape[2]), Q)
    mixed = np.einsum("iab,jbc->ijac", G, G) + np.einsum("isaf,jscf->ijac", between, between)
    trace = np.trace(G, axis1=1, axis2=2) + np.einsum("psff->p", group_gram)
    trace_products = np.einsum("iab,jba->ij", G, G) + np.einsum("isfg,jsgf->ij", group_gram, group_gram)
    T = np.diag(len(U) - 2 * trace) + trace_products + 2 * np.einsum("isaf,jsaf->ij", between, between)
    W = 2 * np.linalg.inv(T)
    correction = 2 * (np.einsum("i,iab->ab", np.diag(W), G) - np.einsum("ij,ijab->ab", W, mixed))
    middle = np.eye(root.shape[1]) + (correction + correction.T) / 2
    a = np.einsum("ka,pab,kb->kp", root, G, root) / (root**2).sum(axis=1)[:, None]
    return Confidence(root @ middle @ root.T, 2 / np.einsum("ki,ij,kj->k", a, W, a))
