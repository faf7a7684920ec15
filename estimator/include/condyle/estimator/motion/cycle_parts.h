// SPDX-License-Identifier: Apache-2.0
// Parts of MotionCycles (motion_cycles.h): typical travel, standstills, the flank of a rise, and
// what is largest on the way.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "condyle/estimator/math/arithmetic.h"
#include "condyle/estimator/sample.h"

namespace condyle {

/// What MotionCycles is fed with: the estimate at one instant. All finite.
template <class Scalar>
struct CycleSample {
  TimeNs time_ns = 0;
  Scalar height_m = 0, height_sd_m = 0;
  Scalar rate_m_s = 0, rate_sd_m_s = 0;  ///< of the height
  Scalar speed_m_s = 0, speed_sd_m_s = 0;
};

namespace internal {

/// An instant with its standard deviation.
template <class Scalar>
struct CycleInstant {
  TimeNs time_ns = 0;
  Scalar sd_s = 0;
};

/// A value and its standard deviation.
template <class Scalar>
struct CycleExtreme {
  Scalar value = 0, sd = 0;
  void raise(Scalar other, Scalar other_sd) {
    if (other > value) *this = {other, other_sd};
  }
};

/// `time_ns` and `share` of the way to `next_ns`.
template <class Scalar>
TimeNs between_ns(TimeNs time_ns, TimeNs next_ns, Scalar share) {
  return time_ns + static_cast<TimeNs>(share * static_cast<Scalar>(next_ns - time_ns));
}

template <class Scalar>
Scalar between_s(TimeNs begin_ns, TimeNs end_ns) {
  return static_cast<Scalar>(end_ns - begin_ns) * Scalar(1e-9);
}

/// The 90th percentile of the last rises and falls of at least `least_m`, which the samples of a
/// height show.
template <class Scalar>
class TypicalTravel {
 public:
  explicit TypicalTravel(Scalar least_m) : least_m_(least_m) {}

  /// The next height (m).
  void add(Scalar height_m) {
    if (!has_begun_) low_m_ = high_m_ = turn_m_ = height_m;
    has_begun_ = true;
    low_m_ = std::min(low_m_, height_m);
    high_m_ = std::max(high_m_, height_m);
    if (direction_ >= 0 && high_m_ - height_m >= least_m_) {
      turn(high_m_, -1);
      low_m_ = height_m;
    } else if (direction_ <= 0 && height_m - low_m_ >= least_m_) {
      turn(low_m_, 1);
      high_m_ = height_m;
    }
  }
  /// 0 before the first one (m).
  Scalar percentile_90_m() const { return percentile_m_; }

 private:
  void turn(Scalar at_m, int direction) {
    if (direction_ != 0) {
      travels_m_[count_++ % travels_m_.size()] = std::abs(at_m - turn_m_);
      auto sorted = travels_m_;
      const std::size_t known = std::min(count_, sorted.size());
      const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(known * 9 / 10);
      std::nth_element(sorted.begin(), at, sorted.begin() + static_cast<std::ptrdiff_t>(known));
      percentile_m_ = *at;
    }
    turn_m_ = at_m;
    direction_ = direction;
  }

  Scalar least_m_;
  bool has_begun_ = false;
  int direction_ = 0;
  Scalar low_m_ = 0, high_m_ = 0, turn_m_ = 0, percentile_m_ = 0;
  std::array<Scalar, 64> travels_m_{};
  std::size_t count_ = 0;
};

/// Where v passes zero nearest to the extreme of z, and the slope of v before it.
template <class Scalar>
class Standstill {
 public:
  /// `sign`: 1 at a bottom, -1 at a top.
  explicit Standstill(Scalar sign) : sign_(sign) {}

  /// The extreme of z has moved to `sample`.
  void move_to(const CycleSample<Scalar>& sample) {
    extreme_ns_ = sample.time_ns;
    best_ = {sample.time_ns, Scalar(kSampleSd_s)};
    if (has_last_ && is_near(last_crossing_.time_ns)) best_ = last_crossing_;
    has_after_ = false;
  }
  /// The next sample; after move_to. `slope_m_s2`: of v before it, 0 if not known.
  void add(const CycleSample<Scalar>& before, const CycleSample<Scalar>& sample,
           Scalar slope_m_s2) {
    const Scalar v0 = sign_ * before.rate_m_s, v1 = sign_ * sample.rate_m_s;
    if (!(v0 <= Scalar(0) && v1 > Scalar(0))) return;
    last_crossing_.time_ns = between_ns(before.time_ns, sample.time_ns, v0 / (v0 - v1));
    last_crossing_.sd_s = std::min(sample.rate_sd_m_s / std::abs(slope_m_s2), Scalar(kMostSd_s));
    if (!std::isfinite(last_crossing_.sd_s)) last_crossing_.sd_s = Scalar(kMostSd_s);
    has_last_ = true;
    if (has_after_ || !is_near(last_crossing_.time_ns)) return;
    has_after_ = true;
    const TimeNs distance_ns = std::abs(last_crossing_.time_ns - extreme_ns_);
    if (best_.time_ns == extreme_ns_ || distance_ns < std::abs(best_.time_ns - extreme_ns_)) {
      best_ = last_crossing_;
    }
  }
  CycleInstant<Scalar> instant() const { return best_; }

 private:
  static constexpr TimeNs kSearch_ns = 80'000'000;
  static constexpr double kSampleSd_s = 0.02, kMostSd_s = 0.1;

  bool is_near(TimeNs time_ns) const { return std::abs(time_ns - extreme_ns_) < kSearch_ns; }

  Scalar sign_;
  TimeNs extreme_ns_ = 0;
  bool has_last_ = false, has_after_ = false;
  CycleInstant<Scalar> last_crossing_, best_;
};

/// The slope of v over at least 25 ms before the latest sample.
template <class Scalar>
class RateSlope {
 public:
  void add(const CycleSample<Scalar>& sample) {
    if (count_ > 0 && sample.time_ns - at(0).time_ns < kSpacing_ns) return;
    points_[count_++ % points_.size()] = {sample.time_ns, sample.rate_m_s};
  }
  /// 0 if it is not known.
  Scalar before(const CycleSample<Scalar>& sample) const {
    const std::size_t known = std::min(count_, points_.size());
    for (std::size_t i = 0; i < known; ++i) {
      if (sample.time_ns - at(i).time_ns < kReach_ns) continue;
      return (sample.rate_m_s - at(i).rate_m_s) / between_s<Scalar>(at(i).time_ns, sample.time_ns);
    }
    return 0;
  }

 private:
  static constexpr TimeNs kSpacing_ns = 3'000'000, kReach_ns = 25'000'000;
  struct Point {
    TimeNs time_ns;
    Scalar rate_m_s;
  };
  // The latest is number 0.
  const Point& at(std::size_t i) const { return points_[(count_ - 1 - i) % points_.size()]; }

  std::array<Point, 12> points_{};
  std::size_t count_ = 0;
};

/// Where a height first exceeded a level since its last bottom: the highest values so far, with the
/// times at which they were reached.
template <class Scalar>
class RisingFlank {
 public:
  void clear() { count_ = 0; }
  /// The next sample; kept if it exceeds the last one kept by `least_m`.
  void add(const CycleSample<Scalar>& sample, Scalar least_m) {
    if (count_ > 0 && sample.height_m < at(0).height_m + least_m) return;
    points_[count_++ % points_.size()] = {sample.time_ns, sample.height_m};
  }
  /// The first time above `level_m`, interpolated; that of the first sample kept if it lies above.
  TimeNs passage_ns(Scalar level_m) const {
    const std::size_t known = std::min(count_, points_.size());
    if (known == 0) return 0;
    std::size_t above = 0;  // the earliest one
    while (above + 1 < known && at(above + 1).height_m > level_m) ++above;
    if (above + 1 >= known || at(above).height_m <= level_m) return at(above).time_ns;
    const Point& low = at(above + 1);
    const Point& high = at(above);
    return between_ns(low.time_ns, high.time_ns,
                      (level_m - low.height_m) / (high.height_m - low.height_m));
  }

 private:
  struct Point {
    TimeNs time_ns;
    Scalar height_m;
  };
  // The latest is number 0.
  const Point& at(std::size_t i) const { return points_[(count_ - 1 - i) % points_.size()]; }

  std::array<Point, 64> points_{};
  std::size_t count_ = 0;
};

/// When a height last fell below a level.
template <class Scalar>
struct FallingPassage {
  bool has_passed = false;
  TimeNs time_ns = 0;
  void add(const CycleSample<Scalar>& before, const CycleSample<Scalar>& sample, Scalar level_m) {
    if (sample.height_m > level_m) {
      has_passed = false;
    } else if (!has_passed) {
      has_passed = true;
      const Scalar fall_m = before.height_m - sample.height_m;
      time_ns = before.height_m > level_m ? between_ns(before.time_ns, sample.time_ns,
                                                       (before.height_m - level_m) / fall_m)
                                          : sample.time_ns;
    }
  }
};

/// What is largest on a part of the way.
template <class Scalar>
struct CycleStretch {
  CycleExtreme<Scalar> speed_m_s;
  TimeNs gap_ns = 0;
  void add(const CycleStretch& more) {
    speed_m_s.raise(more.speed_m_s.value, more.speed_m_s.sd);
    gap_ns = std::max(gap_ns, more.gap_ns);
  }
};

}  // namespace internal

}  // namespace condyle
