// SPDX-License-Identifier: Apache-2.0
// The elementary functions against libm in long double (64 bits of mantissa or more), with the
// bounds stated in their header.
#include "condyle/estimator/math/elementary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>

namespace condyle {
namespace {

constexpr long double kHalfPi = 1.57079632679489661923132169163975144L;

// Distance of `value` from `exact` in units of the last place of Scalar at `exact`.
template <class Scalar>
double ulps(Scalar value, long double exact) {
  using Limits = std::numeric_limits<Scalar>;
  if (std::isnan(exact)) return std::isnan(value) ? 0 : HUGE_VAL;
  if (static_cast<long double>(value) == exact) return 0;
  const auto rounded = static_cast<Scalar>(exact);
  if (std::isinf(rounded) || std::isinf(value)) {
    // At the edge of the range either neighbour is right.
    const bool edge = std::abs(exact) > static_cast<long double>(Limits::max()) * (1 - 0x1p-52L);
    const bool same = std::signbit(value) == std::signbit(exact);
    return same && (value == rounded || (edge && std::abs(value) >= Limits::max())) ? 0 : HUGE_VAL;
  }
  int exponent = 0;
  static_cast<void>(std::frexp(exact, &exponent));
  exponent = std::max(exponent, Limits::min_exponent) - Limits::digits;
  return static_cast<double>(
      std::abs(std::ldexp(static_cast<long double>(value) - exact, -exponent)));
}

// The largest error seen, and where.
template <class Scalar>
class Worst {
 public:
  void see(Scalar x, Scalar value, long double exact) {
    ++count_;
    const double error = ulps(value, exact);
    if (error <= worst_) return;
    worst_ = error;
    at_ = x;
    value_ = value;
  }
  void expect_at_most(double bound, const char* what) const {
    EXPECT_LE(worst_, bound) << what << " at " << std::hexfloat << at_ << ": " << value_;
    testing::Test::RecordProperty(std::string(what) + (sizeof(Scalar) == 4 ? "_float" : "_double"),
                                  std::to_string(worst_));
    EXPECT_GT(count_, 1000U);
  }

 private:
  double worst_ = 0;
  Scalar at_ = 0, value_ = 0;
  std::size_t count_ = 0;
};

// A number in [0, 1): SplitMix64.
double next_share(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15U);
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  return static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
}

// Gives `visit` numbers spread evenly over [lowest, highest], the ends included.
template <class Scalar, class Visit>
void sweep(double lowest, double highest, int count, const Visit& visit) {
  std::uint64_t state = 1;
  visit(static_cast<Scalar>(lowest));
  visit(static_cast<Scalar>(highest));
  for (int i = 0; i < count; ++i) {
    visit(static_cast<Scalar>(lowest + (highest - lowest) * next_share(state)));
  }
}

// Gives `visit` numbers of every magnitude and both signs.
template <class Scalar, class Visit>
void sweep_magnitudes(int lowest_exponent, int highest_exponent, int per_exponent,
                      const Visit& visit) {
  std::uint64_t state = 2;
  for (int k = lowest_exponent; k <= highest_exponent; ++k) {
    for (int i = 0; i < per_exponent; ++i) {
      const auto x = static_cast<Scalar>(std::ldexp(1 + next_share(state), k));
      if (std::isinf(x)) continue;
      visit(x);
      visit(-x);
    }
  }
}

// Gives `visit` the `count` numbers on each side of `centre`.
template <class Scalar, class Visit>
void sweep_neighbours(Scalar centre, int count, const Visit& visit) {
  Scalar up = centre, down = centre;
  for (int i = 0; i < count; ++i) {
    visit(up);
    visit(down);
    up = std::nextafter(up, HUGE_VALF);
    down = std::nextafter(down, -HUGE_VALF);
  }
}

template <class Scalar>
class Elementary : public testing::Test {
 protected:
  using Limits = std::numeric_limits<Scalar>;
  static constexpr bool kDouble = sizeof(Scalar) == 8;
  // Exponents from the smallest subnormal number to the largest number.
  static constexpr int kLowest = Limits::min_exponent - Limits::digits;
  static constexpr int kHighest = Limits::max_exponent - 1;
  static constexpr Scalar kInfinity = Limits::infinity();
  static constexpr Scalar kNaN = Limits::quiet_NaN();
};

using Scalars = testing::Types<float, double>;
class Names {
 public:
  template <class Scalar>
  static std::string GetName(int) {
    return sizeof(Scalar) == 4 ? "Float" : "Double";
  }
};
TYPED_TEST_SUITE(Elementary, Scalars, Names);

TYPED_TEST(Elementary, Exp) {
  using Scalar = TypeParam;
  // A subnormal result rounds twice, in steps of its own.
  Worst<Scalar> normal, subnormal;
  const auto visit = [&](Scalar x) {
    const long double exact = std::exp(static_cast<long double>(x));
    const bool is_normal = exact >= static_cast<long double>(TestFixture::Limits::min());
    (is_normal ? normal : subnormal).see(x, elementary::exp(x), exact);
  };
  const double top = std::log(static_cast<double>(TestFixture::Limits::max()));
  const double bottom = std::log(static_cast<double>(TestFixture::Limits::denorm_min()));
  sweep<Scalar>(bottom - 2, top + 2, 400'000, visit);
  sweep<Scalar>(-1, 1, 200'000, visit);
  sweep<Scalar>(top - 1, top + 0.01, 50'000, visit);
  sweep<Scalar>(bottom - 0.8, std::log(static_cast<double>(TestFixture::Limits::min())) + 0.1,
                100'000, visit);
  sweep_magnitudes<Scalar>(TestFixture::kLowest, TestFixture::kHighest, 50, visit);
  sweep_neighbours<Scalar>(static_cast<Scalar>(top), 1000, visit);
  sweep_neighbours<Scalar>(static_cast<Scalar>(bottom), 1000, visit);
  for (int k = -100; k <= 100; ++k) {  // where the reduction changes its k
    sweep_neighbours<Scalar>(static_cast<Scalar>((k + 0.5) * 0.6931471805599453), 100, visit);
  }
  normal.expect_at_most(1, "exp");
  subnormal.expect_at_most(1, "exp_subnormal");
  EXPECT_EQ(elementary::exp(Scalar(0)), 1);
  EXPECT_EQ(elementary::exp(Scalar(-0.0)), 1);
  EXPECT_EQ(elementary::exp(TestFixture::kInfinity), TestFixture::kInfinity);
  EXPECT_EQ(elementary::exp(-TestFixture::kInfinity), 0);
  EXPECT_TRUE(std::isnan(elementary::exp(TestFixture::kNaN)));
}

TYPED_TEST(Elementary, Log) {
  using Scalar = TypeParam;
  Worst<Scalar> worst;
  const auto visit = [&](Scalar x) {
    if (x > 0) worst.see(x, elementary::log(x), std::log(static_cast<long double>(x)));
  };
  sweep_magnitudes<Scalar>(TestFixture::kLowest, TestFixture::kHighest, 300, visit);
  sweep<Scalar>(0.4, 2.5, 400'000, visit);
  sweep<Scalar>(0.99, 1.01, 100'000, visit);
  sweep_neighbours<Scalar>(1, 10'000, visit);
  sweep_neighbours<Scalar>(static_cast<Scalar>(std::sqrt(2.0)), 1000, visit);
  sweep_neighbours<Scalar>(TestFixture::Limits::min(), 1000, visit);
  visit(TestFixture::Limits::denorm_min());
  visit(TestFixture::Limits::max());
  worst.expect_at_most(TestFixture::kDouble ? 1 : 0.51, "log");
  EXPECT_EQ(elementary::log(Scalar(1)), 0);
  EXPECT_EQ(elementary::log(Scalar(0)), -TestFixture::kInfinity);
  EXPECT_EQ(elementary::log(Scalar(-0.0)), -TestFixture::kInfinity);
  EXPECT_EQ(elementary::log(TestFixture::kInfinity), TestFixture::kInfinity);
  for (const Scalar bad : {Scalar(-1), -TestFixture::Limits::denorm_min(), -TestFixture::kInfinity,
                           TestFixture::kNaN}) {
    EXPECT_TRUE(std::isnan(elementary::log(bad))) << bad;
  }
}

TYPED_TEST(Elementary, QuickLog) {
  using Scalar = TypeParam;
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<double> exponent(-37, 37);
  const double bound = std::is_same_v<Scalar, float> ? 1e-5 : 1e-9;
  for (int i = 0; i < 100'000; ++i) {
    const auto x = static_cast<Scalar>(std::pow(10.0, exponent(generator)));
    ASSERT_NEAR(static_cast<double>(elementary::quick_log(x)), std::log(static_cast<double>(x)),
                bound)
        << x;
  }
  EXPECT_EQ(elementary::quick_log(Scalar(1)), Scalar(0));
}

TYPED_TEST(Elementary, SinAndCos) {
  using Scalar = TypeParam;
  Worst<Scalar> sine, cosine;
  const auto visit = [&](Scalar x) {
    sine.see(x, elementary::sin(x), std::sin(static_cast<long double>(x)));
    cosine.see(x, elementary::cos(x), std::cos(static_cast<long double>(x)));
  };
  sweep<Scalar>(-7, 7, 300'000, visit);
  sweep<Scalar>(-1e5, 1e5, 200'000, visit);
  sweep<Scalar>(-0x1p20, 0x1p20, 100'000, visit);
  sweep_magnitudes<Scalar>(TestFixture::kLowest, 19, 100, visit);
  for (int n = -2000; n <= 2000; ++n) {
    sweep_neighbours<Scalar>(static_cast<Scalar>(n * kHalfPi), 20, visit);
    sweep_neighbours<Scalar>(static_cast<Scalar>((n + 0.5L) * kHalfPi), 10, visit);
  }
  for (int n = 1; n <= 667'543; n += 3) visit(static_cast<Scalar>(n * kHalfPi));
  sine.expect_at_most(TestFixture::kDouble ? 1 : 0.51, "sin");
  cosine.expect_at_most(TestFixture::kDouble ? 1 : 0.51, "cos");
  EXPECT_EQ(elementary::cos(Scalar(0)), 1);
  EXPECT_TRUE(std::signbit(elementary::sin(Scalar(-0.0))));
  for (const Scalar bad : {Scalar(0x1.00002p20), Scalar(-0x1.00002p20), TestFixture::kInfinity,
                           -TestFixture::kInfinity, TestFixture::kNaN}) {
    EXPECT_TRUE(std::isnan(elementary::sin(bad))) << bad;
    EXPECT_TRUE(std::isnan(elementary::cos(bad))) << bad;
  }
}

TYPED_TEST(Elementary, Tanh) {
  using Scalar = TypeParam;
  Worst<Scalar> worst;
  const auto visit = [&](Scalar x) {
    worst.see(x, elementary::tanh(x), std::tanh(static_cast<long double>(x)));
  };
  sweep<Scalar>(-2, 2, 300'000, visit);
  sweep<Scalar>(-25, 25, 100'000, visit);
  sweep_magnitudes<Scalar>(TestFixture::kLowest, TestFixture::kHighest, 50, visit);
  sweep_neighbours<Scalar>(1, 1000, visit);
  worst.expect_at_most(TestFixture::kDouble ? 1.5 : 0.51, "tanh");
  EXPECT_TRUE(std::signbit(elementary::tanh(Scalar(-0.0))));
  EXPECT_EQ(elementary::tanh(TestFixture::kInfinity), 1);
  EXPECT_EQ(elementary::tanh(-TestFixture::kInfinity), -1);
  EXPECT_TRUE(std::isnan(elementary::tanh(TestFixture::kNaN)));
}

// The definitions cancel near 0; there the series in long double is the reference.
long double exact_phi1(long double x) {
  if (std::abs(x) > 0.5L) return -std::expm1(-x) / x;
  long double sum = 0;
  for (int k = 25; k >= 1; --k) sum = (1 - x * sum) / static_cast<long double>(k + 1);
  return 1 - x * sum;
}
long double exact_phi2(long double x) {
  if (std::abs(x) > 2) return x > 1e9L ? (1 - exact_phi1(x)) / x : (x + std::expm1(-x)) / (x * x);
  long double sum = 0;
  for (int k = 40; k >= 1; --k) sum = (1 - x * sum) / static_cast<long double>(k + 2);
  return (1 - x * sum) / 2;
}

TYPED_TEST(Elementary, Phi1AndPhi2) {
  using Scalar = TypeParam;
  Worst<Scalar> first, second, first_below, second_below;
  const auto visit = [&](Scalar x) {
    if (!(x >= -80)) return;
    (x < -1 ? first_below : first)
        .see(x, elementary::phi1(x), exact_phi1(static_cast<long double>(x)));
    (x < -1 ? second_below : second)
        .see(x, elementary::phi2(x), exact_phi2(static_cast<long double>(x)));
  };
  sweep<Scalar>(-1, 1, 300'000, visit);
  sweep<Scalar>(-1e-3, 1e-3, 50'000, visit);
  sweep<Scalar>(-80, 80, 300'000, visit);
  sweep<Scalar>(-4, -1, 100'000, visit);
  sweep<Scalar>(1, 4, 100'000, visit);
  sweep_magnitudes<Scalar>(TestFixture::kLowest, TestFixture::kHighest - 3, 50, visit);
  for (const double edge : {-1.0, 0.0, 1.0}) {
    sweep_neighbours(static_cast<Scalar>(edge), 2000, visit);
  }
  first.expect_at_most(1.5, "phi1");
  second.expect_at_most(2.5, "phi2");
  first_below.expect_at_most(6, "phi1_below");
  second_below.expect_at_most(6, "phi2_below");
  EXPECT_EQ(elementary::phi1(Scalar(0)), 1);
  EXPECT_EQ(elementary::phi2(Scalar(0)), Scalar(0.5));
  EXPECT_EQ(elementary::phi1(TestFixture::kInfinity), 0);
  EXPECT_EQ(elementary::phi2(TestFixture::kInfinity), 0);
  EXPECT_EQ(elementary::phi1(-TestFixture::kInfinity), TestFixture::kInfinity);
  EXPECT_EQ(elementary::phi2(-TestFixture::kInfinity), TestFixture::kInfinity);
  EXPECT_TRUE(std::isnan(elementary::phi1(TestFixture::kNaN)));
  EXPECT_TRUE(std::isnan(elementary::phi2(TestFixture::kNaN)));
}

TYPED_TEST(Elementary, Pow) {
  using Scalar = TypeParam;
  Worst<Scalar> normal, subnormal;
  const auto visit = [&](Scalar x, Scalar y) {
    const long double exact = std::pow(static_cast<long double>(x), static_cast<long double>(y));
    const bool is_normal = exact >= static_cast<long double>(TestFixture::Limits::min());
    (is_normal ? normal : subnormal).see(x, elementary::pow(x, y), exact);
  };
  std::uint64_t state = 3;
  const int range = TestFixture::Limits::max_exponent;
  for (int i = 0; i < 200'000; ++i) {
    // Any base; an exponent that fills the range of results and a little more.
    const auto any = static_cast<Scalar>(
        std::ldexp(1 + next_share(state), static_cast<int>((2 * next_share(state) - 1) * range)));
    const auto near_one = static_cast<Scalar>(1 + std::ldexp(next_share(state) - 0.5, -(i % 20)));
    for (const Scalar x : {any, near_one}) {
      if (x == 1 || !(x > 0) || std::isinf(x)) continue;
      const double widest = 1.1 * range / std::log2(static_cast<double>(x));
      visit(x, static_cast<Scalar>(widest * (2 * next_share(state) - 1)));
      visit(x, static_cast<Scalar>(4 * next_share(state) - 2));
    }
  }
  normal.expect_at_most(TestFixture::kDouble ? 1.1 : 0.51, "pow");
  subnormal.expect_at_most(1, "pow_subnormal");

  const Scalar infinity = TestFixture::kInfinity;
  const Scalar values[] = {0,
                           Scalar(-0.0),
                           TestFixture::Limits::denorm_min(),
                           Scalar(0.5),
                           1,
                           2,
                           TestFixture::Limits::max(),
                           infinity,
                           TestFixture::kNaN,
                           -1,
                           -2,
                           Scalar(-0.5),
                           -TestFixture::Limits::max(),
                           -infinity};
  for (const Scalar x : values) {
    for (const Scalar y : values) {
      const Scalar actual = elementary::pow(x, y);
      if (x < 0 && y != 0) {
        EXPECT_TRUE(std::isnan(actual)) << x << ' ' << y;
      } else if (!std::signbit(x) || y == 0) {
        const long double exact =
            std::pow(static_cast<long double>(x), static_cast<long double>(y));
        EXPECT_LE(ulps(actual, exact), 1) << x << ' ' << y << ' ' << actual;
      }
    }
  }
}

TEST(ElementaryBits, AreTheSameEverywhere) {
  // Recorded once; another machine or compiler setting that gives other bits fails here.
  std::uint64_t hash = 0xcbf29ce484222325U;
  const auto add = [&](auto value) {
    const auto bits = std::bit_cast<std::uint64_t>(static_cast<double>(value));
    for (unsigned i = 0; i < 8; ++i) hash = (hash ^ ((bits >> (8 * i)) & 0xffU)) * 0x100000001b3U;
  };
  const auto add_all = [&](auto x) {
    using Scalar = decltype(x);
    add(elementary::exp(x));
    add(elementary::log(x < 0 ? -x : x));
    add(elementary::sin(x));
    add(elementary::cos(x));
    add(elementary::tanh(x));
    add(elementary::phi1(x));
    add(elementary::phi2(x));
    add(elementary::pow(x < 0 ? -x : x, Scalar(0.37)));
  };
  std::uint64_t state = 4;
  for (int i = 0; i < 20'000; ++i) {
    const double x = 80 * (2 * next_share(state) - 1);
    add_all(x);
    add_all(static_cast<float>(x));
  }
  EXPECT_EQ(hash, 1521593787792075918U);
}

TEST(ElementaryBits, AreTheSameInConstantExpressions) {
  constexpr double at_compile_time = elementary::exp(1.0) + elementary::log(3.0) +
                                     elementary::sin(2.0) + elementary::pow(1.5, 2.5) +
                                     elementary::tanh(0.3) + elementary::phi2(0.7);
  volatile double one = 1;
  const double at_run_time = elementary::exp(1.0 * one) + elementary::log(3.0 * one) +
                             elementary::sin(2.0 * one) + elementary::pow(1.5 * one, 2.5) +
                             elementary::tanh(0.3 * one) + elementary::phi2(0.7 * one);
  EXPECT_EQ(at_compile_time, at_run_time);
}

}  // namespace
}  // namespace condyle
