// Fractions of 32 bits: reciprocals, square roots and angles without a float or a division, a few units of the last
// place from the truth. Qn: the number times 2^n.
#ifndef SPOOR_RULES_FRACTION_H
#define SPOOR_RULES_FRACTION_H
#include "language.h"

SPOOR_RULES_BEGIN

RULE_CONST kFullTurnBits = 32;  // an angle is a uint: its share of a full turn, which wraps by itself

/// mantissa * 2^exponent; mantissa in [2^31, 2^32), or 0.
struct Scaled {
  uint mantissa;
  int exponent;
};

/// value * 2^-exponent, rounded down to a uint, where it fits one. value >= 0.
RULE uint scaledTo(wide value, int exponent) {
  return uint(wideLow(wideUp(wideDown(value, maxInt(exponent, 0)), maxInt(-exponent, 0))));
}

/// A number >= 0 to 32 bits, rounded down.
RULE Scaled scaledFrom(wide value) {
  Scaled scaled;
  scaled.exponent = wideTop(value) - 31;
  scaled.mantissa = scaledTo(value, scaled.exponent);
  return scaled;
}

/// 1 / s in Q31 for s in Q32, 1/2 <= s < 1: at most 8 units too small. Newton's iteration from a line.
RULE uint reciprocal(uint s) {
  uint z = 1768515946u - mulHigh(s, 4042322161u);  // 48/17 - 32/17 s; its carry cancels
  for (int i = 0; i < 3; ++i) z = mulHigh(z, 0u - mulHigh(s, z)) << 1;
  return z;
}

/// 1 / sqrt(a) in Q31 for a in Q32, 1/4 <= a < 1: at most 16 units too small. Newton's iteration from a line.
RULE uint reciprocalRoot(uint a) {
  uint y = 322122547u - mulHigh(a, 2657541734u);  // 2.15 - 1.2375 a; its carry cancels
  for (int i = 0; i < 4; ++i) y = mulHigh(y, 0xc0000000u - mulHigh(a, mulHigh(y, y))) << 1;
  return y;
}

/// sqrt(t) in Q31 for t in Q31, 0 <= t <= 1.
RULE uint rootQ31(uint t) {
  bool whole = t >= 0x80000000u;
  uint part = whole ? 0x7fffffffu : maxUint(t, 1u);
  int shift = (30 - topBit(part)) & ~1;
  uint a = (part << 1) << uint(shift);
  uint root = mulHigh(a, reciprocalRoot(a)) >> uint(shift >> 1);
  return whole ? 0x80000000u : (t == 0u ? 0u : root);
}

/// atan(a) / (2 pi) for a in Q32, 0 <= a < 1: in Q32 of a turn, within 4 units. A polynomial in a^2 that was fitted to
/// the smallest error, 4.5e-10.
RULE uint eighthTurn(uint a) {
  uint z = mulHigh(a, a);
  uint p = 28675971u - mulHigh(z, 4651443u);  // Q34, as are all of these
  p = 82989923u - mulHigh(z, p);
  p = 156097752u - mulHigh(z, p);
  p = 228303282u - mulHigh(z, p);
  p = 298918761u - mulHigh(z, p);
  p = 389906073u - mulHigh(z, p);
  p = 546799594u - mulHigh(z, p);
  p = 911418808u - mulHigh(z, p);
  p = 2734261095u - mulHigh(z, p);
  return mulHigh(a, p) >> 2;
}

/// The direction of (x, y) from +x towards +y, as a share of a full turn; 0 for (0, 0). Ranges: +-2^24.
RULE uint turnOf(int x, int y) {
  uint ax = uint(absInt(x)), ay = uint(absInt(y));
  uint most = maxUint(maxUint(ax, ay), 1u), least = minUint(ax, ay);
  int shift = 31 - topBit(most);
  uint ratio = mulHigh(least << uint(shift), reciprocal(most << uint(shift)));  // a few units less than 1 where equal
  uint turn = eighthTurn(least == most ? 0xffffffffu : minUint(ratio, 0x7fffffffu) << 1);
  uint steep = 0u - uint(ay > ax), west = 0u - uint(x < 0), south = 0u - uint(y < 0);
  turn = (turn ^ steep) - steep + (steep & 0x40000000u);
  turn = (turn ^ west) - west + (west & 0x80000000u);
  return (turn ^ south) - south;
}

SPOOR_RULES_END

#endif
