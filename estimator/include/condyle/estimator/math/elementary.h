// SPDX-License-Identifier: Apache-2.0
// Elementary functions with the same bits on every machine, unlike those of libm.
//
// Only + - * /, comparisons and std::bit_cast; no fused multiply-add (condyle_floating_point sees
// to that), no state, no libm. Every function is constexpr.
//
//   function   method                                          error in ulp: double, float
//   exp        e^x = 2^k e^r, |r| <= ln2/2, ln2 in two parts; Taylor          1,   1
//   log        x = 2^k m, m about 1; 2 atanh(s), s = (m - 1)/(m + 1)          1,   0.51
//   sin, cos   x = n pi/2 + r, pi/2 in four parts (Cody, Waite 1980),         1,   0.51
//              r in two, |r| <= pi/4; Taylor
//   tanh       x - x (cosh x - sinh(x)/x)/cosh x, Taylor; beyond 1            1.5, 0.51
//              1 - 2t/(1 + t), t = e^-2x
//   pow        exp(y log x), log and product in two parts (Dekker 1971)       1.1, 0.51
//   phi1       Taylor for |x| <= 1, else the definition; x >= -1              1.5, 1.5
//   phi2       the same                                                       2.5, 2.5
//   quick_log  as log, fewer terms; for comparisons                           (see there)
//
// The bounds are those the tests assert against long double; measured, not proved. An ulp of a
// result below the smallest normal number is the smallest number.
// The float functions other than exp, phi1 and phi2 compute in double.
// sin and cos: NaN beyond |x| = 2^20, where the reduction ends; keep phases within a few turns.
// phi1 and phi2 below -1: the error grows to 6 ulp; infinite where e^-x is.
// NaN in, NaN out. log: -inf at 0, NaN below. pow: NaN for x < 0, 1 for x = 1 or y = 0.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "condyle/estimator/math/arithmetic.h"

namespace condyle::elementary {
namespace detail {

/// Properties of a floating-point format that the functions need.
template <class Scalar>
struct Format;

template <>
struct Format<double> {
  using Bits = std::uint64_t;
  static constexpr int fraction_bits = 52;
  static constexpr int bias = 1023;
  static constexpr double ln2_high = 0x1.62e42feep-1;  // 32 bits: its product with k is exact
  static constexpr double ln2_low = 0x1.a39ef35793c76p-33;
  static constexpr std::size_t exp_terms = 12;
  static constexpr std::size_t phi_terms = 19;
};

template <>
struct Format<float> {
  using Bits = std::uint32_t;
  static constexpr int fraction_bits = 23;
  static constexpr int bias = 127;
  static constexpr float ln2_high = 0x1.62e4p-1F;  // 15 bits
  static constexpr float ln2_low = 0x1.7f7d1cp-20F;
  static constexpr std::size_t exp_terms = 6;
  static constexpr std::size_t phi_terms = 11;
};

template <class Scalar>
inline constexpr Scalar kInfinity = std::numeric_limits<Scalar>::infinity();
template <class Scalar>
inline constexpr Scalar kNotANumber = std::numeric_limits<Scalar>::quiet_NaN();

/// 1/first!, 1/(first + step)!, ...
template <class Scalar, std::size_t n>
consteval std::array<Scalar, n> reciprocal_factorials(int first, int step) {
  std::array<Scalar, n> result = {};
  double factorial = 1;
  int of = 1;
  for (std::size_t i = 0; i < n; ++i) {
    for (const int next = first + static_cast<int>(i) * step; of < next;) factorial *= ++of;
    result[i] = Scalar(1 / factorial);
  }
  return result;
}

/// 2/first, 2/(first + 2), ...: the series of 2 atanh(s) from the power `first` on.
template <std::size_t n>
consteval std::array<double, n> atanh_coefficients(int first) {
  std::array<double, n> result = {};
  for (std::size_t i = 0; i < n; ++i) result[i] = 2.0 / (first + 2 * static_cast<int>(i));
  return result;
}

/// 2/3!, 4/5!, 6/7!, ...: cosh x - sinh(x)/x from x^2 on.
template <std::size_t n>
consteval std::array<double, n> cosh_less_sinh_coefficients() {
  std::array<double, n> result = reciprocal_factorials<double, n>(3, 2);
  for (std::size_t i = 0; i < n; ++i) result[i] *= 2 * static_cast<double>(i) + 2;
  return result;
}

template <class Scalar>
inline constexpr auto kExpSeries =
    reciprocal_factorials<Scalar, Format<Scalar>::exp_terms>(2, 1);  // from r^2 on
template <class Scalar>
inline constexpr auto kPhi1Series = reciprocal_factorials<Scalar, Format<Scalar>::phi_terms>(1, 1);
template <class Scalar>
inline constexpr auto kPhi2Series = reciprocal_factorials<Scalar, Format<Scalar>::phi_terms>(2, 1);
inline constexpr auto kSinSeries = reciprocal_factorials<double, 8>(3, 2);  // from r^3 on
inline constexpr auto kCosSeries = reciprocal_factorials<double, 7>(4, 2);  // from r^4 on
inline constexpr auto kCoshSeries = reciprocal_factorials<double, 10>(0, 2);
inline constexpr auto kTanhSeries = cosh_less_sinh_coefficients<10>();  // from x^2 on
inline constexpr auto kLogSeries = atanh_coefficients<10>(3);           // from s^3 on
inline constexpr auto kPowSeries = atanh_coefficients<10>(5);           // from s^5 on

/// c[0] + c[1] x + c[2] x^2 + ...
template <class Scalar, std::size_t n>
constexpr Scalar polynomial(Scalar x, const std::array<Scalar, n>& c) {
  Scalar sum = c[n - 1];
  for (std::size_t i = n - 1; i-- > 0;) sum = sum * x + c[i];
  return sum;
}

/// The integer nearest to `x`, |x| < 2^31.
template <class Scalar>
constexpr int nearest_integer(Scalar x) {
  return static_cast<int>(x < 0 ? x - Scalar(0.5) : x + Scalar(0.5));
}

/// 2^k, for k that give a normal number.
template <class Scalar>
constexpr Scalar power_of_two(int k) {
  using Bits = typename Format<Scalar>::Bits;
  return std::bit_cast<Scalar>(static_cast<Bits>(k + Format<Scalar>::bias)
                               << Format<Scalar>::fraction_bits);
}

/// y 2^k for y about 1: into infinity and into the subnormal numbers.
template <class Scalar>
constexpr Scalar scale(Scalar y, int k) {
  constexpr int bias = Format<Scalar>::bias;
  if (k > bias) return y * power_of_two<Scalar>(bias) * power_of_two<Scalar>(k - bias);
  if (k <= -bias) return y * power_of_two<Scalar>(k + 64) * power_of_two<Scalar>(-64);
  return y * power_of_two<Scalar>(k);
}

/// e^(x + low), |low| far below |x|.
template <class Scalar>
constexpr Scalar exp_of_sum(Scalar x, Scalar low) {
  using F = Format<Scalar>;
  // If k is outside the range of `scale`, the result overflows or vanishes before.
  if (x > Scalar(F::bias) * F::ln2_high + 1) return kInfinity<Scalar>;
  if (x < -Scalar(F::bias + F::fraction_bits + 2) * F::ln2_high) return 0;
  if (!(x == x)) return x;
  const int k = nearest_integer(x * Scalar(0x1.71547652b82fep+0));
  const Scalar high = x - Scalar(k) * F::ln2_high;
  const Scalar rest = low - Scalar(k) * F::ln2_low;
  const Scalar r = high + rest;
  const Scalar lost = (high - r) + rest;
  return scale(1 + (r + (lost + r * r * polynomial(r, kExpSeries<Scalar>))), k);
}

/// high + low, |low| at most half an ulp of high or close to it.
struct TwoParts {
  double high, low;
};

/// a + b exactly (Knuth).
constexpr TwoParts two_sum(double a, double b) {
  const double sum = a + b;
  const double b_seen = sum - a;
  return {sum, (a - (sum - b_seen)) + (b - b_seen)};
}

/// a b exactly (Veltkamp, Dekker).
constexpr TwoParts two_product(double a, double b) {
  constexpr double splitter = 0x1p27 + 1;
  const double a_big = splitter * a, b_big = splitter * b;
  const double a_high = a_big - (a_big - a), b_high = b_big - (b_big - b);
  const double a_low = a - a_high, b_low = b - b_high;
  const double product = a * b;
  return {product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

/// x = 2^k (1 + f), 1 + f from sqrt(1/2) to sqrt(2).
struct Binary {
  int k;
  double f;
};

/// Decomposes `x`, which must be positive and finite.
constexpr Binary take_apart(double x) {
  int k = 0;
  if (x < std::numeric_limits<double>::min()) {
    x *= 0x1p54;
    k = -54;
  }
  auto bits = std::bit_cast<std::uint64_t>(x);
  k += static_cast<int>(bits >> 52U) - 1023;
  bits = (bits & 0xfffffffffffffU) | 0x3ff0000000000000U;
  double m = std::bit_cast<double>(bits);
  if (m > 0x1.6a09e667f3bcdp+0) {
    m *= 0.5;
    ++k;
  }
  return {k, m - 1};
}

/// log x to about 70 bits, x positive and finite.
constexpr TwoParts log_in_two_parts(double x) {
  const auto [k, f] = take_apart(x);
  // s = f / (2 + f)
  const TwoParts d = two_sum(2, f);
  const double s = f / d.high;
  const TwoParts sd = two_product(s, d.high);
  const double s_low = (((f - sd.high) - sd.low) - s * d.low) / d.high;
  // 2 s^3 / 3
  const TwoParts ss = two_product(s, s);
  const double ss_low = ss.low + 2 * s * s_low;
  const TwoParts sss = two_product(ss.high, s);
  const double sss_low = sss.low + ss_low * s + ss.high * s_low;
  constexpr double two_thirds = 2.0 / 3, two_thirds_low = 0x1.5555555555555p-55;
  const TwoParts cubic = two_product(sss.high, two_thirds);
  const double cubic_low = cubic.low + sss_low * two_thirds + sss.high * two_thirds_low;

  const double tail = sss.high * ss.high * polynomial(ss.high, kPowSeries);
  const TwoParts log_m = two_sum(2 * s, cubic.high);
  const double low = log_m.low + (2 * s_low + (cubic_low + tail));
  const TwoParts sum = two_sum(k * Format<double>::ln2_high, log_m.high);
  return two_sum(sum.high, sum.low + (low + k * Format<double>::ln2_low));
}

/// x = quadrant pi/2 + (high + low), |high| <= pi/4; |x| <= 2^20.
struct ReducedAngle {
  int quadrant;
  double high, low;
};

constexpr ReducedAngle reduce_angle(double x) {
  const int n = nearest_integer(x * 0x1.45f306dc9c883p-1);
  const double a = x - n * 0x1.921fb544p+0;  // 33 bits each: these products are exact
  const TwoParts b = two_sum(a, n * -0x1.0b4611a6p-34);
  const TwoParts c = two_sum(b.high, n * -0x1.3198a2ep-69);
  const TwoParts r = two_sum(c.high, c.low + b.low - n * 0x1.b839a252049c1p-104);
  return {n & 3, r.high, r.low};
}

constexpr double sin_of_reduced(ReducedAngle r) {
  const double square = r.high * r.high;
  const double correction = -r.high * square * polynomial(-square, kSinSeries);
  return r.high + (correction + r.low * (1 - 0.5 * square));
}

constexpr double cos_of_reduced(ReducedAngle r) {
  const double square = r.high * r.high;
  const double half = 0.5 * square;
  const double first = 1 - half;
  const double correction = square * square * polynomial(-square, kCosSeries);
  return first + (((1 - first) - half) + (correction - r.high * r.low));
}

/// sin(x + turns pi/2).
constexpr double sine(double x, int turns) {
  if (!(x >= -0x1p20 && x <= 0x1p20)) return kNotANumber<double>;
  const ReducedAngle r = reduce_angle(x);
  const int quadrant = (r.quadrant + turns) & 3;
  const double value = (quadrant & 1) != 0 ? cos_of_reduced(r) : sin_of_reduced(r);
  return quadrant >= 2 ? -value : value;
}

}  // namespace detail

/// e^x.
template <class Scalar>
constexpr Scalar exp(Scalar x) {
  return detail::exp_of_sum(x, Scalar(0));
}

/// Natural logarithm.
template <class Scalar>
constexpr Scalar log(Scalar x) {
  if constexpr (std::is_same_v<Scalar, float>) {
    return static_cast<float>(log(static_cast<double>(x)));
  } else {
    if (!(x > 0)) return x == 0 ? -detail::kInfinity<double> : detail::kNotANumber<double>;
    if (x == detail::kInfinity<double>) return x;
    // log(1 + f) = 2 atanh(s) = f - (f^2/2 - s (f^2/2 + R)), R the series from s^2 on
    const auto [k, f] = detail::take_apart(x);
    const double s = f / (2 + f);
    const double R = s * s * detail::polynomial(s * s, detail::kLogSeries);
    const double half = 0.5 * f * f;
    const double low = s * (half + R) + k * detail::Format<double>::ln2_low;
    return k * detail::Format<double>::ln2_high - ((half - low) - f);
  }
}

/// Natural logarithm of a positive normal `x` for comparisons: absolute error below 1e-9 in double,
/// 1e-5 in float, in a third of the time of `log`. In float it computes in float.
template <class Scalar>
constexpr Scalar quick_log(Scalar x) {
  using F = detail::Format<Scalar>;
  using Bits = typename F::Bits;
  constexpr Bits fraction = (Bits{1} << F::fraction_bits) - 1;
  constexpr Bits one = static_cast<Bits>(F::bias) << F::fraction_bits;
  const Bits bits = std::bit_cast<Bits>(x);
  int k = static_cast<int>(bits >> F::fraction_bits) - F::bias;
  Scalar m = std::bit_cast<Scalar>((bits & fraction) | one);
  if (m > Scalar(0x1.6a09e667f3bcdp+0)) {
    m *= Scalar(0.5);
    ++k;
  }
  // 2 atanh(s), |s| <= 0.172; the first term left out is 2 s^11 / 11 < 7e-10
  const Scalar s = (m - Scalar(1)) / (m + Scalar(1));
  const Scalar z = s * s;
  const Scalar series = z * (Scalar(1) / 3 + z * (Scalar(1) / 5 + z * (Scalar(1) / 7 + z / 9)));
  return Scalar(k) * Scalar(0x1.62e42fefa39efp-1) + (s + s) * (Scalar(1) + series);
}

/// Sine of `x` radians, |x| <= 2^20; NaN beyond.
template <class Scalar>
constexpr Scalar sin(Scalar x) {
  if (x == 0) return x;
  return static_cast<Scalar>(detail::sine(static_cast<double>(x), 0));
}

/// Cosine of `x` radians, |x| <= 2^20; NaN beyond.
template <class Scalar>
constexpr Scalar cos(Scalar x) {
  return static_cast<Scalar>(detail::sine(static_cast<double>(x), 1));
}

/// (1 - e^-x) / x, 1 at 0.
template <class Scalar>
constexpr Scalar phi1(Scalar x) {
  if (x >= -1 && x <= 1) return detail::polynomial(-x, detail::kPhi1Series<Scalar>);
  const Scalar e = exp(-x);
  if (e == detail::kInfinity<Scalar>) return e;
  return (1 - e) / x;
}

/// (x - 1 + e^-x) / x^2, 1/2 at 0.
template <class Scalar>
constexpr Scalar phi2(Scalar x) {
  if (x >= -1 && x <= 1) return detail::polynomial(-x, detail::kPhi2Series<Scalar>);
  if (x > Scalar(1e18)) return 1 / x;  // x^2 might overflow
  const Scalar e = exp(-x);
  if (e == detail::kInfinity<Scalar>) return e;
  return ((x - 1) + e) / (x * x);
}

/// Hyperbolic tangent.
template <class Scalar>
constexpr Scalar tanh(Scalar x) {
  if constexpr (std::is_same_v<Scalar, float>) {
    return static_cast<float>(tanh(static_cast<double>(x)));
  } else {
    if (x == 0) return x;
    const double size = x < 0 ? -x : x;
    double result = 0;
    if (size <= 1) {
      const double square = x * x;
      const double D = square * detail::polynomial(square, detail::kTanhSeries);
      result = size - size * (D / detail::polynomial(square, detail::kCoshSeries));
    } else {
      const double t = exp(-2 * size);
      result = 1 - 2 * t / (1 + t);
    }
    return x < 0 ? -result : result;
  }
}

/// x^y for x >= 0; NaN for x < 0.
template <class Scalar>
constexpr Scalar pow(Scalar x, Scalar y) {
  if constexpr (std::is_same_v<Scalar, float>) {
    return static_cast<float>(pow(static_cast<double>(x), static_cast<double>(y)));
  } else {
    constexpr double infinity = detail::kInfinity<double>;
    if (y == 0 || x == 1) return 1;
    if (!(x >= 0) || !(y == y)) return detail::kNotANumber<double>;
    if (x == 0 || x == infinity) return (x == 0) == (y > 0) ? 0 : infinity;
    const detail::TwoParts l = detail::log_in_two_parts(x);
    const double rough = y * l.high;
    // Also keeps infinite and huge y out of the exact product.
    if (rough > 720 || rough < -760) return rough > 0 ? infinity : 0;
    const detail::TwoParts product = detail::two_product(y, l.high);
    return detail::exp_of_sum(product.high, product.low + y * l.low);
  }
}

}  // namespace condyle::elementary
