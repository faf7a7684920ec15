// SPDX-License-Identifier: Apache-2.0
#include "quality/step_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace condyle::host {
namespace {

double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

void StepWatch::add(TimeNs time_ns, const std::array<double, 3>& position_m) {
  if (has_last_ && time_ns > last_time_ns_) {
    Step step{};
    for (std::size_t i = 0; i < 3; ++i) step.d_m[i] = position_m[i] - last_m_[i];
    step.duration_s = seconds(time_ns - last_time_ns_);
    std::shift_left(steps_.begin(), steps_.end(), 1);
    steps_.back() = step;
    count_ = std::min(count_ + 1, kWindow);
    for (std::size_t i = 0; i < 3; ++i) roundings_[i].add(position_m[i]);
    if (count_ == kWindow) {
      dropped_.add(ratio(0));
      held_.add(ratio(1));
    }
  } else {
    count_ = 0;
  }
  has_last_ = true;
  last_time_ns_ = time_ns;
  last_m_ = position_m;
}

void StepWatch::add_missing() {
  has_last_ = false;
  count_ = 0;
}

double StepWatch::ratio(std::size_t left_out) const {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto [shortest, longest] =
      std::minmax_element(steps_.begin(), steps_.end(),
                          [](const Step& a, const Step& b) { return a.duration_s < b.duration_s; });
  if (longest->duration_s > (1 + kEven) * shortest->duration_s) return kNone;
  std::array<const Vector*, 2 * kSide> around{};  // evenly spaced under the line model
  for (std::size_t i = 0; i < kSide; ++i) {
    around[i] = &steps_[i].d_m;
    around[kSide + i] = &steps_[kSide + 1 + left_out + i].d_m;
  }
  constexpr double kSquares = 2 * (0.5 * 0.5 + 1.5 * 1.5 + 2.5 * 2.5);
  const auto place = [](std::size_t i) { return static_cast<double>(i) - (kSide - 0.5); };
  Vector mean{}, slope{};
  for (std::size_t i = 0; i < around.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      mean[axis] += (*around[i])[axis] / (2 * kSide);
      slope[axis] += place(i) * (*around[i])[axis] / kSquares;
    }
  }
  const double square_m2 = dot(mean, mean);
  double grid_square_m2 = 0;
  for (const RoundingStep<double>& rounding : roundings_) {
    grid_square_m2 += rounding.step_m() * rounding.step_m();
  }
  if (!(square_m2 > kFewestGridSteps * kFewestGridSteps * grid_square_m2)) return kNone;
  const auto is_far = [&](const auto& rest_m) {
    const Vector rest = {rest_m(0), rest_m(1), rest_m(2)};
    return dot(rest, rest) > kScatter * kScatter * square_m2;
  };
  for (std::size_t i = 0; i < around.size(); ++i) {
    if (is_far([&](std::size_t axis) {
          return (*around[i])[axis] - mean[axis] - place(i) * slope[axis];
        })) {
      return kNone;
    }
  }
  const Vector& d_m = steps_[kSide].d_m;
  const double q = dot(d_m, mean) / square_m2;
  return is_far([&](std::size_t axis) { return d_m[axis] - q * mean[axis]; }) ? kNone : q;
}

void StepWatch::Tally::add(double ratio) {
  const auto is_near = [ratio](double centre) { return std::abs(ratio - centre) < 0.25; };
  there += is_near(q) ? 1U : 0U;
  between += is_near((q + 1) / 2) ? 1U : 0U;
}

// True if at least `there` successes are improbable: the tail of a binomial distribution at 1/2.
bool StepWatch::Tally::is_found() const {
  if (there <= between) return false;
  const auto n = static_cast<double>(there + between);
  double sum = 0;
  for (std::uint64_t k = there; k <= there + between; ++k) {
    const auto x = static_cast<double>(k);
    sum += std::exp(std::lgamma(n + 1) - std::lgamma(x + 1) - std::lgamma(n - x + 1) -
                    n * std::log(2.0));
  }
  return sum <= kFalseAlarm;
}

}  // namespace condyle::host
