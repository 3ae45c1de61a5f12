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
  return uint(wideLow(exponent >= 0 ? wideDown(value, exponent) : wideUp(value, -exponent)));
}

/// A number >= 0 to 32 bits, rounded down.
RULE Scaled scaledFrom(wide value) {
  Scaled scaled;
  scaled.exponent = wideTop(value) - 31;
  scaled.mantissa = wideZero(value) ? 0u : scaledTo(value, scaled.exponent);
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
  if (t == 0u) return 0u;
  if (t >= 0x80000000u) return 0x80000000u;
  int shift = (30 - topBit(t)) & ~1;
  uint a = (t << 1) << uint(shift);
  return mulHigh(a, reciprocalRoot(a)) >> uint(shift >> 1);
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
  bool steep = ay > ax;
  uint most = steep ? ay : ax, least = steep ? ax : ay;
  if (least == 0u) return steep ? (y > 0 ? 0x40000000u : 0xc0000000u) : (x < 0 ? 0x80000000u : 0u);
  int shift = 31 - topBit(most);
  uint ratio = least == most ? 0x80000000u : mulHigh(least << uint(shift), reciprocal(most << uint(shift)));
  uint turn = eighthTurn(ratio >= 0x80000000u ? 0xffffffffu : ratio << 1);
  if (steep) turn = 0x40000000u - turn;
  if (x < 0) turn = 0x80000000u - turn;
  return y < 0 ? 0u - turn : turn;
}

SPOOR_RULES_END

#endif
