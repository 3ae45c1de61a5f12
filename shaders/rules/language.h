// The common subset of C++ and GLSL in which every rule header is written (DESIGN.md, invariant 4).
//
// 32-bit ints only; products that need more go through the wide helpers below. No negative operand to `/` or `%`
// (floorDiv is for that), no shift of 32 or more, no overflow of a signed int: each rule states its ranges.
// In C++ the rules live in spoor::rules; `static` keeps a copy per translation unit, because one of them may be
// compiled for a newer processor than the rest and the linker would otherwise be free to pick that copy for all.
#ifndef SPOOR_RULES_LANGUAGE_H
#define SPOOR_RULES_LANGUAGE_H

#ifdef __cplusplus
#include <cstdint>
#define RULE static inline
#define RULE_CONST static constexpr int
#define RULE_OUT(type) type&
#define SPOOR_RULES_BEGIN namespace spoor::rules {
#define SPOOR_RULES_END }
#else
#define RULE
#define RULE_CONST const int
#define RULE_OUT(type) out type
#define SPOOR_RULES_BEGIN
#define SPOOR_RULES_END
#endif

SPOOR_RULES_BEGIN

#ifdef __cplusplus

using uint = std::uint32_t;
/// A signed 64-bit value. Only the wide* helpers touch it.
using wide = std::int64_t;

RULE wide wideFrom(int a) { return a; }
RULE wide wideMul(int a, int b) { return wide(a) * b; }
RULE wide wideAdd(wide a, wide b) { return a + b; }
RULE wide wideSub(wide a, wide b) { return a - b; }
RULE bool wideNegative(wide a) { return a < 0; }
RULE bool wideZero(wide a) { return a == 0; }
RULE int wideLow(wide a) { return int(a); }
/// a * b where the product fits 64 bits.
RULE wide wideTimes(wide a, int b) { return a * b; }
/// floor(a / b); b > 0.
RULE wide wideFloorDiv(wide a, wide b) { return a / b - (a % b < 0 ? 1 : 0); }
/// floor(a / 2^30) where that fits an int.
RULE int wideFromQ30(wide a) { return int(a >> 30); }
/// a * 2^bits, cut off at 64 bits; bits 0..63.
RULE wide wideUp(wide a, int bits) { return wide(std::uint64_t(a) << bits); }
/// The bits of a, shifted down by 0..63, zeros from above: floor(a / 2^bits) for a >= 0.
RULE wide wideDown(wide a, int bits) { return wide(std::uint64_t(a) >> bits); }

/// The high word of a * b.
RULE uint mulHigh(uint a, uint b) { return uint(std::uint64_t(a) * b >> 32); }

/// Place of the highest bit, -1 for 0.
#ifdef SPOOR_KERNELS_NAME
// By halves: loops over it are to be vectorised, and few processors count zeros of many numbers at once.
RULE int topBit(uint a) {
  int top = a == 0 ? -1 : 0;
  int shift = a > 0xffffu ? 16 : 0;
  uint rest = a >> shift;
  top += shift;
  shift = rest > 0xffu ? 8 : 0;
  rest >>= shift;
  top += shift;
  shift = rest > 0xfu ? 4 : 0;
  rest >>= shift;
  top += shift;
  return top + (rest > 7u ? 3 : rest > 3u ? 2 : rest > 1u ? 1 : 0);
}
#else
RULE int topBit(uint a) { return a == 0 ? -1 : 31 - __builtin_clz(a); }
#endif
/// The same of a >= 0.
RULE int wideTop(wide a) {
  const uint high = uint(std::uint64_t(a) >> 32);
  return topBit(high != 0 ? high : uint(a)) + (high != 0 ? 32 : 0);
}

/// a / count. Ranges: a >= 0, count 1..8. By a reciprocal of 31 + `places` bits, rounded up, which is exact. Branches
/// would keep loops over it from being vectorised.
RULE int dividedByCount(int a, int count) {
  const uint of_power = 1u << 31;
  uint reciprocal = of_power + (uint(count == 7) * (2454267027u - of_power)) +
                    (uint(count == 5) * (3435973837u - of_power)) +
                    ((uint(count == 3) | uint(count == 6)) * (2863311531u - of_power));
  uint places = uint(count > 1) + uint(count > 2) + uint(count > 4);
  return int(uint(std::uint64_t(uint(a) * 2u) * reciprocal >> 32) >> places);
}

RULE int minInt(int a, int b) { return a < b ? a : b; }
RULE int maxInt(int a, int b) { return a > b ? a : b; }
RULE uint maxUint(uint a, uint b) { return a > b ? a : b; }
RULE uint minUint(uint a, uint b) { return a < b ? a : b; }

#else

// A signed 64-bit value, two's complement. Only the wide* helpers touch it.
struct wide {
  uint low;
  uint high;
};

wide wideFrom(int a) { return wide(uint(a), a < 0 ? 0xffffffffu : 0u); }
// By halves: umulExtended and imulExtended lose the high word in Mesa 22.3 where both factors are constants.
wide wideMulUnsigned(uint a, uint b) {
  uint low = (a & 0xffffu) * (b & 0xffffu);
  uint middle = (a >> 16) * (b & 0xffffu) + (low >> 16);
  uint middle_b = (a & 0xffffu) * (b >> 16) + (middle & 0xffffu);
  return wide((middle_b << 16) | (low & 0xffffu), (a >> 16) * (b >> 16) + (middle >> 16) + (middle_b >> 16));
}
wide wideMul(int a, int b) {
  wide product = wideMulUnsigned(uint(a), uint(b));
  if (a < 0) product.high -= uint(b);
  if (b < 0) product.high -= uint(a);
  return product;
}
wide wideAdd(wide a, wide b) {
  uint low = a.low + b.low;
  return wide(low, a.high + b.high + (low < a.low ? 1u : 0u));
}
wide wideSub(wide a, wide b) { return wide(a.low - b.low, a.high - b.high - (a.low < b.low ? 1u : 0u)); }
bool wideNegative(wide a) { return (a.high & 0x80000000u) != 0u; }
bool wideZero(wide a) { return (a.low | a.high) == 0u; }
int wideLow(wide a) { return int(a.low); }
wide wideTimes(wide a, int b) {
  wide product = wideMulUnsigned(a.low, uint(b));
  product.high += a.high * uint(b);
  if (b < 0) product.high -= a.low;
  return product;
}
int topBit(uint a) { return findMSB(a); }
int wideTop(wide a) { return a.high != 0u ? 32 + findMSB(a.high) : findMSB(a.low); }
wide wideUp(wide a, int bits) {
  if (bits >= 32) return wide(0u, a.low << uint(bits - 32));
  return bits == 0 ? a : wide(a.low << uint(bits), (a.high << uint(bits)) | (a.low >> uint(32 - bits)));
}
wide wideDown(wide a, int bits) {
  if (bits >= 32) return wide(a.high >> uint(bits - 32), 0u);
  return bits == 0 ? a : wide((a.low >> uint(bits)) | (a.high << uint(32 - bits)), a.high >> uint(bits));
}
/// Bit by bit, as many as the quotient has.
wide wideFloorDiv(wide a, wide b) {
  bool negative = wideNegative(a);
  wide zero = wide(0u, 0u);
  wide rest = negative ? wideSub(zero, a) : a;
  wide quotient = zero;
  int places = wideTop(rest) - wideTop(b);
  wide part = wideUp(b, places > 0 ? places : 0);
  for (; places >= 0; --places) {
    wide less = wideSub(rest, part);
    bool fits = !wideNegative(less);
    if (fits) rest = less;
    quotient = wide((quotient.low << 1) | (fits ? 1u : 0u), (quotient.high << 1) | (quotient.low >> 31));
    part = wide((part.low >> 1) | (part.high << 31), part.high >> 1);
  }
  if (!negative) return quotient;
  wide result = wideSub(zero, quotient);
  return wideZero(rest) ? result : wideSub(result, wide(1u, 0u));
}
int wideFromQ30(wide a) { return int((a.high << 2) | (a.low >> 30)); }

uint mulHigh(uint a, uint b) { return wideMulUnsigned(a, b).high; }

int dividedByCount(int a, int count) { return a / count; }

int minInt(int a, int b) { return min(a, b); }
int maxInt(int a, int b) { return max(a, b); }
uint maxUint(uint a, uint b) { return max(a, b); }
uint minUint(uint a, uint b) { return min(a, b); }

#endif

/// a, or the nearer of the bounds where it lies outside them.
RULE int wideClamp(wide a, int low, int high) {
  if (wideNegative(wideSub(a, wideFrom(low)))) return low;
  return wideNegative(wideSub(wideFrom(high), a)) ? high : wideLow(a);
}

/// floor(a / b) for b > 0. Range: a > -2^31.
RULE int floorDiv(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }
RULE int clampInt(int a, int low, int high) { return minInt(maxInt(a, low), high); }
RULE int absInt(int a) { return a < 0 ? -a : a; }
/// floor(a * share / 2^16). Ranges: a >= 0, share 0..2^16. In halves of 32 bits, so that loops over it vectorise.
RULE int timesQ16(int a, int share) {
  return int(uint(a >> 16) * uint(share) + (uint(a & 0xffff) * uint(share) >> 16));
}

SPOOR_RULES_END

#endif
