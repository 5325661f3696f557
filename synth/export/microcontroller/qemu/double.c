/* Sums of doubles for cores without an FPU for them, where the compiler's library misses the last bit of some: 1 - 2^-33 c.
 *
 * The linker puts them in its place (--wrap), so that the simulated plant has the bits of other machines. */
#include <stdint.h>

typedef uint64_t bits_t; /* of a double; the ABI passes both in the same registers */

bits_t __real___aeabi_dadd(bits_t a, bits_t b);
bits_t __wrap___aeabi_dadd(bits_t a, bits_t b);
bits_t __wrap___aeabi_dsub(bits_t a, bits_t b);
bits_t __wrap___aeabi_drsub(bits_t a, bits_t b);

#define SIGN (1ull << 63)
#define UNIT (1ull << 52)

static bits_t rounded(bits_t sign, bits_t m, uint32_t e)
{
    /* m has three bits below the last one; the lowest stands for all that were lost. */
    if ((m >> 56) != 0u) {
        m = (m >> 1) | (m & 1u);
        e += 1u;
    }
    while ((m >> 55) == 0u && e > 1u) {
        m <<= 1;
        e -= 1u;
    }
    const uint32_t below = (uint32_t)m & 7u;
    m >>= 3;
    if (below > 4u || (below == 4u && (m & 1u) != 0u)) m += 1u;
    return sign | (m + ((bits_t)(e - 1u) << 52)); /* a carry goes on into the exponent */
}

bits_t __wrap___aeabi_dadd(bits_t a, bits_t b)
{
    if ((a & ~SIGN) < (b & ~SIGN)) {
        const bits_t larger = b;
        b = a;
        a = larger;
    }
    uint32_t ea = (uint32_t)(a >> 52) & 0x7FFu, eb = (uint32_t)(b >> 52) & 0x7FFu;
    if (ea >= 0x7FEu || (b & ~SIGN) == 0u) return __real___aeabi_dadd(a, b);
    const bits_t ma = ((a & (UNIT - 1u)) | (ea ? UNIT : 0u)) << 3, mb = ((b & (UNIT - 1u)) | (eb ? UNIT : 0u)) << 3;
    ea = ea ? ea : 1u;
    eb = eb ? eb : 1u;
    const uint32_t d = ea - eb;
    const bits_t moved = (d > 60u) ? 1u : (mb >> d) | ((mb & ((1ull << d) - 1u)) != 0u);
    const bits_t m = (((a ^ b) & SIGN) != 0u) ? ma - moved : ma + moved;
    return (m == 0u) ? 0u : rounded(a & SIGN, m, ea);
}

bits_t __wrap___aeabi_dsub(bits_t a, bits_t b)
{
    return __wrap___aeabi_dadd(a, b ^ SIGN);
}

bits_t __wrap___aeabi_drsub(bits_t a, bits_t b)
{
    return __wrap___aeabi_dadd(a ^ SIGN, b);
}
