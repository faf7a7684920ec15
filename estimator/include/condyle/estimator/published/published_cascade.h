// SPDX-License-Identifier: Apache-2.0
// The published cascade with all its outputs: the estimates of cascade_core.h with standard
// deviations, normalised innovations, provenance, events and verdict.
//
// C. Bogena, S. Hovsepyan, P. Mercorelli, J. Phys.: Conf. Ser. 2162 (2022) 012017,
// doi 10.1088/1742-6596/2162/1/012017; equation numbers are that paper's.
//
// p, v and F come from stage 1, kv from 2, m from 3.
//
// Provenance. F of stage 1 is m0 times the acceleration, so kv = 0 and m = m0 solve stages 2 and 3
// for every motion: every measurement that enters them presupposes the parameter. The information
// share of friction and mass is 0 by construction, and both are always assumed. A step without a
// measurement only predicts: all its values are assumed.
#pragma once

#include "condyle/estimator/events.h"
#include "condyle/estimator/provenance.h"
#include "condyle/estimator/published/cascade_core.h"
#include "condyle/estimator/published/matching_verdict.h"
#include "condyle/estimator/published/parameters.h"

namespace condyle {

/// The results of one step of the published cascade. NaN and `not_computed` if there is no value.
template <class Scalar>
struct PublishedEstimate {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::quiet_NaN();

  Quantity<Scalar> position_m, velocity_m_s, force_N;  ///< stage 1
  Quantity<Scalar> friction_Ns_m;                      ///< stage 2
  Quantity<Scalar> mass_kg;                            ///< stage 3
  Scalar innovation_m = kNone;  ///< measured minus predicted position, stage 1
  Scalar motion_nis = kNone;    ///< normalised innovation squared of stage 1 (1 measurement)
  Scalar friction_nis = kNone;  ///< of stage 2 (2 measurements)
  Scalar mass_nis = kNone;      ///< of stage 3 (2 measurements)
  EventSet events;              ///< unusual properties of this step
  Verdict verdict = Verdict::not_matched;  ///< matching criterion on the run so far
};

/// The published cascade for one axis. One object per run; copying it copies the run.
template <class Scalar>
class PublishedCascade {
 public:
  using Estimate = PublishedEstimate<Scalar>;

  /// `parameters` must satisfy `is_valid`; otherwise every step has the event `parameters_invalid`
  /// and computes nothing.
  explicit PublishedCascade(const PublishedParameters& parameters)
      : sample_time_s_(static_cast<Scalar>(parameters.sample_time_s)),
        parameters_valid_(is_valid(parameters)),
        core_(parameters) {}

  /// Advances by one sample time with the measured position (m). NaN or infinity enters no state:
  /// it counts as `step_without_measurement` with the event `position_missing`.
  Estimate step(Scalar measured_position_m) {
    if (!std::isfinite(measured_position_m)) {
      Estimate estimate = step_without_measurement();
      estimate.events.add(Event::position_missing);
      return estimate;
    }
    if (!parameters_valid_) return invalid_estimate();
    advance_prior();
    const CoreStep<Scalar> step =
        core_.template step<CoreChecks::nis_and_gate>(measured_position_m, sample_time_s_);
    Estimate estimate = current_estimate(step.motion_updated);
    estimate.innovation_m = step.innovation_m;
    estimate.motion_nis = step.motion_nis;
    estimate.friction_nis = step.friction_nis;
    estimate.mass_nis = step.mass_nis;
    estimate.events.add(Event::update_refused, step.refused);
    return estimate;
  }

  /// Advances by one sample time without a measurement: all stages predict, none updates. Before
  /// the first measurement nothing is computed and the event is `not_started`.
  Estimate step_without_measurement() {
    if (!parameters_valid_) return invalid_estimate();
    if (!core_.started()) {
      Estimate estimate;
      estimate.events.add(Event::not_started);
      return estimate;
    }
    advance_prior();
    core_.predict(sample_time_s_);
    return current_estimate(false);
  }

  /// Stage 1's state (position m, velocity m/s, net force N) and its covariance.
  const ThreeStateFilter<Scalar>& motion_filter() const { return core_.motion(); }

 private:
  using Filter = ThreeStateFilter<Scalar>;

  void advance_prior() {
    if (core_.started()) {
      core_.propagate_motion(motion_prior_, sample_time_s_);
    } else {
      motion_prior_ = SymmetricMatrix3<Scalar>::diagonal(core_.initial_motion_variance());
    }
  }

  // Value and standard deviation are always set together.
  static Quantity<Scalar> quantity(const Filter& filter, StateIndex i, Provenance provenance) {
    const Scalar variance = filter.P(i, i);
    if (!std::isfinite(filter.x[i]) || !std::isfinite(variance) || variance < Scalar(0)) return {};
    return {filter.x[i], std::sqrt(variance), provenance};
  }

  // `is_measured`: stage 1 was updated in this step; a prediction alone is assumed.
  Estimate current_estimate(bool is_measured) {
    const Filter &motion = core_.motion(), &friction = core_.friction(), &mass = core_.mass();
    Estimate estimate;
    Provenance motion_provenance[3];
    for (int i = 0; i < 3; ++i) {
      motion_provenance[i] =
          is_measured ? provenance_of_share(information_share(motion.P(i, i), motion_prior_(i, i)))
                      : Provenance::assumed;
    }
    // The force is the measured acceleration times the assumed mass.
    const Provenance force_provenance = motion_provenance[kThird] == Provenance::measured
                                            ? Provenance::derived
                                            : Provenance::assumed;
    estimate.position_m = quantity(motion, kPosition, motion_provenance[kPosition]);
    estimate.velocity_m_s = quantity(motion, kVelocity, motion_provenance[kVelocity]);
    estimate.force_N = quantity(motion, kThird, force_provenance);
    estimate.friction_Ns_m = quantity(friction, kThird, Provenance::assumed);
    estimate.mass_kg = quantity(mass, kThird, Provenance::assumed);
    for (const Filter* filter : {&motion, &friction, &mass}) {
      for (int i = 0; i < 3; ++i) {
        estimate.events.add(Event::estimate_not_finite,
                            !std::isfinite(filter->x[i]) || !std::isfinite(filter->P(i, i)));
        estimate.events.add(Event::variance_negative, filter->P(i, i) < Scalar(0));
      }
    }
    estimate.verdict = matching_.add(mass.x[kThird], core_.assumed_mass_kg());
    return estimate;
  }

  static Estimate invalid_estimate() {
    Estimate estimate;
    estimate.events.add(Event::parameters_invalid);
    return estimate;
  }

  Scalar sample_time_s_;
  bool parameters_valid_;
  CascadeCore<Scalar> core_;
  // Covariance of stage 1 from prior and process noise alone.
  SymmetricMatrix3<Scalar> motion_prior_;
  MatchingCriterion matching_;
};

}  // namespace condyle
