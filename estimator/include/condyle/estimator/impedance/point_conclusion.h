// SPDX-License-Identifier: Apache-2.0
// From the sums of a recording to the results for the point: those of the whole recording
// (point_judgement.h), or of its last part if these are better.
//
// Walk:     a value that may wander by q per root second is given for the end. The mean of T
//           seconds strays from it by q^2 T / 3: the last half or quarter is used if that is better
#pragma once

#include "condyle/estimator/impedance/point_judgement.h"

namespace condyle {

/// Draws the conclusion of a regression. Fixed size, no allocation; about 10 kB of stack.
template <class Scalar>
class PointConclusion {
 public:
  /// Fewest blocks for a judgement.
  static constexpr std::size_t kFewestBlocks = 16;

  /// `parameters` must be valid; both must live as long as this.
  PointConclusion(const PointRegression<Scalar>& regression, const ImpedanceParameters& parameters)
      : regression_(regression), parameters_(parameters), setup_(regression.setup()) {}

  /// The conclusion from everything in the regression so far.
#ifdef CONDYLE_SENSORS_COMPILED  // long, and called once a second: not compiled again in its
                                 // callers
  [[gnu::noinline]]
#endif
  ImpedanceEstimate<Scalar>
  draw() const;

 private:
  ImpedanceEstimate<Scalar> nothing_known() const {
    ImpedanceEstimate<Scalar> estimate;
    const DriveParameters& drive = parameters_.drive;
    const ImpedancePrior delay{drive.delay_s, drive.delay_sd_s, 0};
    const ImpedanceLimit limit = regression_.is_too_slow() ? ImpedanceLimit::too_slow
                                 : regression_.has_drive() ? ImpedanceLimit::too_early
                                                           : ImpedanceLimit::no_drive;
    const auto set = [limit](IdentifiedValue<Scalar>& value, const ImpedancePrior& prior) {
      value.quantity = {Scalar(prior.mean), Scalar(prior.sd), Provenance::assumed};
      value.limit = limit;
    };
    set(estimate.friction_Ns_m, parameters_.friction_Ns_m);
    set(estimate.mass_kg, parameters_.mass_kg);
    set(estimate.stiffness_N_m, parameters_.stiffness_N_m);
    set(estimate.offset_N, parameters_.offset_N);
    set(estimate.coulomb_N, parameters_.coulomb_N);
    set(estimate.delay_s, delay);
    return estimate;
  }

  static void take_better(const IdentifiedValue<Scalar>& recent, IdentifiedValue<Scalar>& value) {
    if (recent.fitted_sd < value.fitted_sd) value = recent;
  }

  const PointRegression<Scalar>& regression_;
  const ImpedanceParameters& parameters_;
  RegressionSetup setup_;
};

template <class Scalar>
ImpedanceEstimate<Scalar> PointConclusion<Scalar>::draw() const {
  ImpedanceEstimate<Scalar> estimate = nothing_known();
  const std::size_t size = regression_.has_begun() ? regression_.blocks().size() : 0;
  if (size < kFewestBlocks) return estimate;
  const internal::PointJudgement<Scalar> all(regression_.blocks(), setup_, parameters_, 0);
  all.write(estimate);
  if (!has_walk(parameters_)) return estimate;
  for (const std::size_t first : {size / 2, size - size / 4}) {
    if (size - first < kFewestBlocks) break;
    ImpedanceEstimate<Scalar> recent = nothing_known();
    const internal::PointJudgement<Scalar> later(regression_.blocks(), setup_, parameters_, first);
    later.write(recent);
    take_better(recent.friction_Ns_m, estimate.friction_Ns_m);
    take_better(recent.mass_kg, estimate.mass_kg);
    take_better(recent.stiffness_N_m, estimate.stiffness_N_m);
    take_better(recent.offset_N, estimate.offset_N);
    take_better(recent.coulomb_N, estimate.coulomb_N);
  }
  return estimate;
}

#ifdef CONDYLE_SENSORS_COMPILED  // once, in a library
extern template class PointConclusion<double>;
extern template class PointConclusion<float>;
#endif

}  // namespace condyle
