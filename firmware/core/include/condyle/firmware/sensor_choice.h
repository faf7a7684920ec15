// SPDX-License-Identifier: Apache-2.0
// Chooses the virtual sensor of a run: one or three axes; recommended estimator with or without a
// drive. No heap, no exceptions.
#pragma once

#include <type_traits>

#include "condyle/estimator/sensors/driven_sensor.h"
#include "condyle/estimator/sensors/learned_sensor.h"
#include "condyle/estimator/sensors/recommended_sensor.h"

namespace condyle::firmware {

/// Calls `use(axes, axis)` for samples of `kind`, and returns its result. `axes`: a
/// std::integral_constant, 1 or 3, the number of axes of the estimate. `axis`: the index of the
/// `followed` one among them.
template <class Use>
decltype(auto) with_axes(SampleKind kind, Axis followed, Use&& use) {
  if (kind == SampleKind::one_axis) return use(std::integral_constant<int, 1>(), 0);
  return use(std::integral_constant<int, 3>(), static_cast<int>(followed));
}

/// What determines a sensor of the recommended estimator.
struct RecommendedChoice {
  SampleKind kind = SampleKind::one_axis;  ///< of the samples
  bool identifies = false;                 ///< friction and mass, from a drive along `axis`
  const DrivenParameters& parameters;
  int lag = 0;  ///< samples
  FollowedPoint point;
  Axis axis = Axis::z;  ///< followed
};

/// The sensor of the recommended estimator for `kAxes` axes, which learns nothing. `kMostLag`:
/// longest lag for which there is memory. `kIdentifies`: it identifies friction and mass.
template <class Scalar, int kAxes, int kMostLag, bool kIdentifies>
using FilterOf = std::conditional_t<kIdentifies, DrivenSensor<Scalar, kAxes, kMostLag>,
                                    RecommendedSensor<Scalar, kAxes, kMostLag>>;

/// The same; a LearnedSensor if there is memory for `kKernels` kernels, above 0.
template <class Scalar, int kAxes, int kMostLag, bool kIdentifies, int kKernels>
using SensorOf = std::conditional_t<(kKernels > 0),
                                    LearnedSensor<FilterOf<Scalar, kAxes, kMostLag, kIdentifies>,
                                                  Scalar, kAxes, kMostLag, kKernels>,
                                    FilterOf<Scalar, kAxes, kMostLag, kIdentifies>>;

/// Calls `use(type, arguments...)` with the sensor for `choice`, as a std::type_identity, and the
/// arguments of its constructor. `kIdentifies`: whether there is memory for friction and mass; the
/// others as in SensorOf.
template <class Scalar, int kMostLag = 16, bool kIdentifies = true, int kKernels = 0, class Use>
decltype(auto) with_recommended_sensor(const RecommendedChoice& choice, Use&& use) {
  return with_axes(choice.kind, choice.axis, [&](auto axes, int axis) -> decltype(auto) {
    constexpr int kAxes = decltype(axes)::value;
    if constexpr (kIdentifies) {
      if (choice.identifies) {
        return use(std::type_identity<SensorOf<Scalar, kAxes, kMostLag, true, kKernels>>(),
                   choice.parameters, choice.lag, choice.point, axis);
      }
    }
    return use(std::type_identity<SensorOf<Scalar, kAxes, kMostLag, false, kKernels>>(),
               choice.parameters, choice.lag, choice.point);
  });
}

/// The same on a host, which has memory for everything.
template <class Use>
decltype(auto) with_hosted_sensor(const RecommendedChoice& choice, Use&& use) {
  return with_recommended_sensor<double, 16, true, kMostKernels>(choice, use);
}

/// True of sensors that identify friction and mass.
template <class Sensor>
inline constexpr bool kIdentifying = requires(Sensor& sensor) {
  sensor.conclude();
};

}  // namespace condyle::firmware
