// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "real_motion/track.h"

namespace condyle::testing_support {
namespace {

// A white-jerk filter in units of its noise, written out apart from the estimator. Its covariance
// is that of all axes.
class Filter {
 public:
  Filter(double ratio, std::size_t axes) : r_(ratio), x_(axes) {}

  void start(std::size_t axis, double position) { x_[axis] = {position, 0, 0}; }

  void predict(double T) {
    const double h = T * T / 2;
    for (State& x : x_) {
      x.p += T * x.v + h * x.a;
      x.v += T * x.a;
    }
    const double a0 = pp_ + T * pv_ + h * pa_, a1 = pv_ + T * vv_ + h * va_,
                 a2 = pa_ + T * va_ + h * aa_;
    const double b1 = vv_ + T * va_, b2 = va_ + T * aa_, rT = r_ * T;
    pp_ = a0 + T * a1 + h * a2 + rT * T * T * T * T / 20;
    pv_ = a1 + T * a2 + rT * T * T * T / 8;
    pa_ = a2 + rT * T * T / 6;
    vv_ = b1 + T * b2 + rT * T * T / 3;
    va_ = b2 + rT * T / 2;
    aa_ += rT;
  }

  double innovation(std::size_t axis, double position) const { return position - x_[axis].p; }
  double innovation_variance() const { return pp_ + 1; }

  void update_state(std::size_t axis, double innovation) {
    const double share = innovation / innovation_variance();
    x_[axis].p += pp_ * share;
    x_[axis].v += pv_ * share;
    x_[axis].a += pa_ * share;
  }
  void update_covariance() {
    const double S = innovation_variance();
    vv_ -= pv_ * pv_ / S;
    va_ -= pv_ * pa_ / S;
    aa_ -= pa_ * pa_ / S;
    pv_ -= pp_ / S * pv_;
    pa_ -= pp_ / S * pa_;
    pp_ -= pp_ / S * pp_;
  }

  double position(std::size_t axis) const { return x_[axis].p; }
  double velocity(std::size_t axis) const { return x_[axis].v; }
  double position_variance() const { return pp_; }
  double velocity_variance() const { return vv_; }

 private:
  struct State {
    double p = 0, v = 0, a = 0;
  };
  double r_;
  std::vector<State> x_;
  double pp_ = 1, pv_ = 0, pa_ = 0, vv_ = 1e12, va_ = 0, aa_ = 1e15;
};

// Calls `look(i, filter)` after sample `i` was predicted and `taken(i, filter)` after its update.
template <class Look, class Taken>
void run(const MotionRecording& recording, const Marks& use, double ratio, Look&& look,
         Taken&& taken) {
  const std::size_t axes = recording.position_m.size();
  Filter filter(ratio, axes);
  bool is_started = false;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    if (is_started) {
      filter.predict(recording.time_s[i] - recording.time_s[i - 1]);
      look(i, filter);
    }
    for (std::size_t axis = 0; use[i] && axis < axes; ++axis) {
      const double position = recording.position_m[axis][i];
      if (is_started) {
        filter.update_state(axis, filter.innovation(axis, position));
      } else {
        filter.start(axis, position);
      }
    }
    if (is_started && use[i]) filter.update_covariance();
    is_started = is_started || use[i];
    if (is_started) taken(i, filter);
  }
}

struct Fit {
  double ratio = 0, variance = 0, likelihood = -HUGE_VAL;
};

}  // namespace

std::vector<Track> oracle_tracks(const TreatedRecording& treated,
                                 const std::vector<ReferenceMotion>& axes) {
  const MotionRecording& recording = treated.recording;
  const std::size_t n = recording.size();
  Marks use(n);
  for (std::size_t i = 0; i < n; ++i) {
    use[i] = recording.is_measured(i);
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      if (axes[axis].is_known && axes[axis].is_irregular[i]) use[i] = false;
      if (treated.has_faults && treated.is_spoiled(axis, i)) use[i] = false;
    }
  }
  const std::size_t settled = std::min<std::size_t>(20, n / 4);
  std::vector<Fit> best(axes.size());
  for (double exponent = 4; exponent < 18.01; exponent += 0.25) {
    const double ratio = std::pow(10, exponent);
    Values squares(axes.size(), 0);
    double count = 0, log_sum = 0;
    run(
        recording, use, ratio,
        [&](std::size_t i, const Filter& filter) {
          if (i < settled || !use[i]) return;
          const double S = filter.innovation_variance();
          ++count;
          log_sum += std::log(S);
          for (std::size_t axis = 0; axis < axes.size(); ++axis) {
            squares[axis] +=
                std::pow(filter.innovation(axis, recording.position_m[axis][i]), 2) / S;
          }
        },
        [](std::size_t, const Filter&) {});
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      const double variance = std::max(squares[axis] / count, 1e-18);
      const double likelihood = -0.5 * (count * std::log(variance) + log_sum);
      if (likelihood > best[axis].likelihood) best[axis] = {ratio, variance, likelihood};
    }
  }

  std::vector<Track> tracks(axes.size(), Track(n));
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    Track& track = tracks[axis];
    const double R = best[axis].variance;
    run(
        recording, use, best[axis].ratio,
        [&](std::size_t i, const Filter& filter) {
          if (!recording.is_measured(i)) return;
          track.innovation_m[i] = filter.innovation(axis, recording.position_m[axis][i]);
          track.innovation_sd_m[i] = std::sqrt(R * filter.innovation_variance());
        },
        [&](std::size_t i, const Filter& filter) {
          track.position_m[i] = filter.position(axis);
          track.velocity_m_s[i] = filter.velocity(axis);
          track.position_sd_m[i] = std::sqrt(R * filter.position_variance());
          track.velocity_sd_m_s[i] = std::sqrt(R * filter.velocity_variance());
        });
  }
  return tracks;
}

}  // namespace condyle::testing_support
