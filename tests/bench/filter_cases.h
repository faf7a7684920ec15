// SPDX-License-Identifier: Apache-2.0
// The filters whose speed is measured. One more: a class like those below, and a line in
// `for_each_case`.
#pragma once

#include <cstdint>
#include <numbers>

#include "condyle/estimator/impedance/point_identification.h"
#include "condyle/estimator/math/elementary.h"
#include "condyle/estimator/motion/recommended_estimator.h"
#include "condyle/estimator/published/cascade_core.h"
#include "condyle/estimator/sensors/learned_sensor.h"
#include "support/dense_cascade.h"

// Compiled as a function of its own that contains all it calls. The large filters would take
// minutes to compile in this way, so their `step` is not inlined.
#if defined(__GNUC__) && !defined(__clang__)
#define CONDYLE_ONE_FUNCTION [[gnu::noipa, gnu::flatten]]
#else
#define CONDYLE_ONE_FUNCTION [[gnu::noinline, gnu::flatten]]
#endif

namespace condyle::bench {

/// Chi-square with 1 degree of freedom: 1 % of good measurements lie above.
inline constexpr double kGate = 6.63;

/// One sample, as a filter is given it.
template <class Scalar>
struct TimedStep {
  Scalar position_m;
  Scalar step_s;  ///< time from the sample before
};

/// A chewing jaw, with 0.1 mm of noise.
class ChewingJaw {
 public:
  template <class Scalar>
  TimedStep<Scalar> next() {
    const double step_s = (1 + 0.1 * noise()) / 60;
    time_s_ += step_s;
    const double phase_rad = 2 * std::numbers::pi * 1.3 * time_s_;
    const double opening_m =
        0.0075 * (1 - elementary::cos(phase_rad));  // on every machine the same
    return {static_cast<Scalar>(-opening_m + 3.5e-4 * noise()), static_cast<Scalar>(step_s)};
  }

 private:
  double noise() {
    random_ = random_ * 1664525U + 1013904223U;  // Numerical Recipes' generator
    return static_cast<double>(random_ >> 8U) * 0x1p-24 - 0.5;
  }

  std::uint32_t random_ = 1;
  double time_s_ = 0;
};

/// The same jaw with what a filter's rare paths need: every 50th sample is a glitch, once in 250
/// six are; after a pause, when little is expected, a glitch passes and is found out by the next
/// sample; once the source pauses until nothing is known.
class SpoiledJaw {
 public:
  template <class Scalar>
  TimedStep<Scalar> next() {
    auto sample = jaw_.next<Scalar>();
    const int i = count_++;
    if (i % 50 == 49 || (i % 250 > 100 && i % 250 <= 106)) sample.position_m += Scalar(0.02);
    if (i % 100 == 77) {
      sample.step_s += Scalar(0.08);
      sample.position_m += Scalar(0.004) * Scalar(1 + i / 100 % 5);
    }
    if (i == 520) sample.step_s = Scalar(0.5);
    return sample;
  }

 private:
  ChewingJaw jaw_;
  int count_ = 0;
};

/// The published cascade alone: no standard deviations, NIS, gate, provenance.
template <class T>
struct PublishedBare {
  using Scalar = T;
  static constexpr const char* kName = "published_bare";
  CascadeCore<Scalar> core{PublishedParameters{}};
  bool all_taken = true;
  void step(Scalar z, Scalar) { all_taken = core.step(z, Scalar(1.0 / 60)); }
};

/// The same with gate, NIS of each stage and variable time step.
template <class T>
struct PublishedChecked {
  using Scalar = T;
  static constexpr const char* kName = "published_checked";
  CascadeCore<Scalar> core{PublishedParameters{}, Scalar(kGate)};
  CoreStep<Scalar> last;
  void step(Scalar z, Scalar step_s) {
    last = core.template step<CoreChecks::nis_and_gate>(z, step_s);
  }
};

/// The textbook's twin of PublishedBare.
template <class T>
struct DenseBare {
  using Scalar = T;
  static constexpr const char* kName = "dense_bare";
  testing_support::DenseCascade<Scalar> cascade{PublishedParameters{}};
  void step(Scalar z, Scalar) { cascade.template step<false>(z, Scalar(1.0 / 60)); }
};

/// The textbook's twin of PublishedChecked.
template <class T>
struct DenseChecked {
  using Scalar = T;
  static constexpr const char* kName = "dense_checked";
  testing_support::DenseCascade<Scalar> cascade{PublishedParameters{}, Scalar(kGate)};
  typename testing_support::DenseCascade<Scalar>::Nis last;
  void step(Scalar z, Scalar step_s) { last = cascade.template step<true>(z, step_s); }
};

/// The recommended estimator, all of it, along `kAxes` axes and `kLag` samples late.
template <class T, int kAxes, int kLag>
struct RecommendedCase {
  using Scalar = T;
  RecommendedEstimator<Scalar, kAxes> estimator{MotionEstimatorParameters{}, kLag};
  RecommendedEstimate<Scalar> last;
  TimeNs time_ns = 0;
  [[gnu::noinline]] void step(Scalar z, Scalar step_s) {
    time_ns += static_cast<TimeNs>(static_cast<double>(step_s) * 1e9);
    TimedPosition<Scalar, kAxes> measurement;
    measurement.time_ns = time_ns;
    measurement.is_measured = true;
    for (Scalar& position_m : measurement.position_m) position_m = z;
    last = estimator.step(measurement);
  }
};
template <class T>
struct RecommendedOneAxis : RecommendedCase<T, 1, 0> {
  static constexpr const char* kName = "recommended_one_axis";
};
template <class T>
struct RecommendedThreeAxes : RecommendedCase<T, 3, 0> {
  static constexpr const char* kName = "recommended_three_axes";
};
template <class T>
struct RecommendedLate : RecommendedCase<T, 3, 10> {
  static constexpr const char* kName = "recommended_three_axes_lag_10";
};

/// The recommended sensor that learns with `kKernels` kernels (learned_sensor.h). It has moved
/// irregularly before, until it uses them all.
template <class T, int kAxes, int kKernels>
struct LearnedCase {
  using Scalar = T;
  using Sensor = LearnedSensor<RecommendedSensor<Scalar, kAxes, 16>, Scalar, kAxes, 16, kKernels>;
  Sensor sensor{parameters(), 0};
  typename Sensor::Estimate last;
  Sample sample;

  LearnedCase() {
    sample.kind = kAxes == 1 ? SampleKind::one_axis : SampleKind::one_point;
    ChewingJaw jaw;
    for (int i = 0; i < 8 * kKernels; ++i) {
      const double t = i / 60.0;
      const auto measured = jaw.next<Scalar>();
      step(
          measured.position_m * static_cast<Scalar>(elementary::cos(0.9 * t + elementary::cos(t))) +
              static_cast<Scalar>(0.005 * elementary::cos(15.7 * t)),
          measured.step_s);
    }
  }
  [[gnu::noinline]] void step(Scalar z, Scalar step_s) {
    sample.time_ns += static_cast<TimeNs>(static_cast<double>(step_s) * 1e9);
    for (int axis = 0; axis < kAxes; ++axis) sample.coordinates[axis] = static_cast<double>(z);
    last = sensor.process(sample, EventSet());
  }
  static DrivenParameters parameters() {
    DrivenParameters parameters;
    parameters.learning.kernels = kKernels;
    return parameters;
  }
};
template <class T>
struct LearnedOneAxis : LearnedCase<T, 1, 64> {
  static constexpr const char* kName = "learned_one_axis_64";
};
template <class T>
struct LearnedThreeAxes : LearnedCase<T, 3, 64> {
  static constexpr const char* kName = "learned_three_axes_64";
};
#if !defined(__arm__)
template <class T>
struct LearnedThreeAxesOnHosts : LearnedCase<T, 3, kMostKernels> {
  static constexpr const char* kName = "learned_three_axes_96";
};
#endif

/// Friction and mass from a drive of the positions' rate; once a second a conclusion is drawn.
template <class T>
struct IdentifiedPoint {
  using Scalar = T;
  static constexpr const char* kName = "identified_point";
  PointIdentification<Scalar> identification{ImpedanceParameters{}};
  TimeNs time_ns = 0;
  [[gnu::noinline]] void step(Scalar z, Scalar step_s) {
    time_ns += static_cast<TimeNs>(static_cast<double>(step_s) * 1e9);
    identification.add_drive(time_ns, Scalar(20) * z);
    identification.add_position(time_ns, z);
  }
};

/// One sample, as a program calls a filter: position (m), time since the sample before (s).
template <class Case>
CONDYLE_ONE_FUNCTION void one_step(Case& filter, typename Case::Scalar z,
                                   typename Case::Scalar step_s) {
  filter.step(z, step_s);
}

/// Calls `visit.operator()<Case<Scalar>>(name)` for each of our filters.
template <class Scalar, class Visitor>
void for_each_filter(Visitor&& visit) {
  const auto give = [&visit]<class Case>() { visit.template operator()<Case>(Case::kName); };
  give.template operator()<PublishedBare<Scalar>>();
  give.template operator()<PublishedChecked<Scalar>>();
  give.template operator()<RecommendedOneAxis<Scalar>>();
  give.template operator()<RecommendedThreeAxes<Scalar>>();
  give.template operator()<RecommendedLate<Scalar>>();
  give.template operator()<LearnedOneAxis<Scalar>>();
  give.template operator()<LearnedThreeAxes<Scalar>>();
#if !defined(__arm__)
  give.template operator()<LearnedThreeAxesOnHosts<Scalar>>();
#endif
#if !defined(__ARM_FP) || (__ARM_FP & 8) != 0  // conclusions are drawn in double
  give.template operator()<IdentifiedPoint<Scalar>>();
#endif
}

/// The same for their dense twins.
template <class Scalar, class Visitor>
void for_each_dense_twin(Visitor&& visit) {
  visit.template operator()<DenseBare<Scalar>>(DenseBare<Scalar>::kName);
  visit.template operator()<DenseChecked<Scalar>>(DenseChecked<Scalar>::kName);
}

}  // namespace condyle::bench
