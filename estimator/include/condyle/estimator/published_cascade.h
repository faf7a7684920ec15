// SPDX-License-Identifier: Apache-2.0
// The published cascade: three extended Kalman filters per sample, in this order.
//
//   stage 1 motion    (p, v, F)   measures z             no input          motion_stage.h
//   stage 2 friction  (p, v, kv)  measures z and v of 1  u = F of 1        friction_stage.h
//   stage 3 mass      (p, v, m)   measures z and v of 1  u = F of 1, kv of 2  mass_stage.h
//
// C. Bogena, S. Hovsepyan, P. Mercorelli, J. Phys.: Conf. Ser. 2162 (2022) 012017,
// doi 10.1088/1742-6596/2162/1/012017; equation numbers are that paper's.
//
// The first sample initialises (p = z, v = 0, F = 0, kv and m from the parameters) and is taken as
// a measurement, without prediction. p, v and F come from stage 1, kv from 2, m from 3.
//
// Provenance. F of stage 1 is m0 times the acceleration seen, so kv = 0 and m = m0 solve stages 2
// and 3 for every motion: no measurement enters them that does not presuppose the parameter. The
// information share of friction and mass is 0 by construction and both are assumed, always. A step
// without a measurement only predicts: all of it is assumed.
#pragma once

#include "condyle/estimator/events.h"
#include "condyle/estimator/friction_stage.h"
#include "condyle/estimator/mass_stage.h"
#include "condyle/estimator/matching_verdict.h"
#include "condyle/estimator/motion_stage.h"
#include "condyle/estimator/parameters.h"
#include "condyle/estimator/provenance.h"

namespace condyle {

/// What one step of the published cascade says. NaN and `not_computed` where there is no value.
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
  EventSet events;              ///< what was unusual about this step
  Verdict verdict = Verdict::not_matched;  ///< matching criterion on the run so far
};

/// The published cascade for one axis. One object per run; copying it copies the run.
template <class Scalar>
class PublishedCascade {
 public:
  using Estimate = PublishedEstimate<Scalar>;

  /// `parameters` must satisfy `is_valid`; otherwise every step says `parameters_invalid` and
  /// computes nothing.
  explicit PublishedCascade(const PublishedParameters& parameters)
      : sample_time_s_(static_cast<Scalar>(parameters.sample_time_s)),
        assumed_mass_kg_(static_cast<Scalar>(parameters.assumed_mass_kg)),
        initial_friction_Ns_m_(static_cast<Scalar>(parameters.friction.initial_Ns_m)),
        initial_mass_kg_(static_cast<Scalar>(parameters.mass.initial_kg)),
        discretisation_(parameters.motion.discretisation),
        motion_noise_(parameters.motion),
        friction_noise_(parameters.friction),
        mass_noise_(parameters.mass),
        parameters_valid_(is_valid(parameters)) {}

  /// One sample time on, with the measured position (m). NaN or infinity enters no state: it counts
  /// as `step_without_measurement` with the event `position_missing`.
  Estimate step(Scalar measured_position_m) {
    if (!std::isfinite(measured_position_m)) {
      Estimate estimate = step_without_measurement();
      estimate.events.add(Event::position_missing);
      return estimate;
    }
    if (!parameters_valid_) return invalid_estimate();
    const Scalar z = measured_position_m;

    if (started_) {
      predict_motion();
    } else {
      start(z);
    }
    const auto motion_update = motion_.template update<kPosition>(z, motion_noise_.R[0]);
    const Scalar v = motion_.x[kVelocity];

    if (started_) predict_friction();
    const Pair friction_update = update_pair(friction_, z, v, friction_noise_);

    if (started_) predict_mass();
    const Pair mass_update = update_pair(mass_, z, v, mass_noise_);
    started_ = true;

    Estimate estimate = current_estimate(!motion_update.refused);
    estimate.innovation_m = motion_update.innovation;
    if (!motion_update.refused) estimate.motion_nis = motion_update.nis;
    if (!friction_update.refused) estimate.friction_nis = friction_update.nis;
    if (!mass_update.refused) estimate.mass_nis = mass_update.nis;
    estimate.events.add(Event::update_refused,
                        motion_update.refused || friction_update.refused || mass_update.refused);
    return estimate;
  }

  /// One sample time on without a measurement: all stages predict, none updates. Before the first
  /// measurement nothing is computed and the event is `not_started`.
  Estimate step_without_measurement() {
    if (!parameters_valid_) return invalid_estimate();
    if (!started_) {
      Estimate estimate;
      estimate.events.add(Event::not_started);
      return estimate;
    }
    predict_motion();
    predict_friction();
    predict_mass();
    return current_estimate(false);
  }

  /// Stage 1's state (position m, velocity m/s, net force N) and its covariance.
  const ThreeStateFilter<Scalar>& motion_filter() const { return motion_; }

 private:
  using Filter = ThreeStateFilter<Scalar>;

  // Variances of one stage in the filter's precision.
  struct StageNoise {
    Vector3<Scalar> initial;
    Vector3<Scalar> Q;
    Scalar R[2] = {};

    template <class StageParameters>
    explicit StageNoise(const StageParameters& stage) {
      for (int i = 0; i < 3; ++i) {
        initial[i] = static_cast<Scalar>(stage.initial_variance[i]);
        Q[i] = static_cast<Scalar>(stage.process_variance[i]);
      }
      int measurement = 0;
      for (const double variance : stage.measurement_variance) {
        R[measurement++] = static_cast<Scalar>(variance);
      }
    }
  };

  struct Pair {
    Scalar nis;
    bool refused;
  };

  void start(Scalar z) {
    motion_.initialise({z, 0, 0}, motion_noise_.initial);
    friction_.initialise({z, 0, initial_friction_Ns_m_}, friction_noise_.initial);
    mass_.initialise({z, 0, initial_mass_kg_}, mass_noise_.initial);
    motion_prior_ = motion_.P;
  }

  void predict_motion() {
    const auto transition =
        motion_transition(motion_.x, sample_time_s_, assumed_mass_kg_, discretisation_);
    motion_.predict(transition, motion_noise_.Q);
    motion_prior_ = propagate_covariance(motion_prior_, transition.jacobian, motion_noise_.Q);
  }
  void predict_friction() {
    friction_.predict(
        friction_transition(friction_.x, motion_.x[kThird], sample_time_s_, assumed_mass_kg_),
        friction_noise_.Q);
  }
  void predict_mass() {
    mass_.predict(mass_transition(mass_.x, motion_.x[kThird], friction_.x[kThird], sample_time_s_),
                  mass_noise_.Q);
  }

  static Pair update_pair(Filter& filter, Scalar z, Scalar v, const StageNoise& noise) {
    const auto position = filter.template update<kPosition>(z, noise.R[0]);
    const auto velocity = filter.template update<kVelocity>(v, noise.R[1]);
    return {position.nis + velocity.nis, position.refused || velocity.refused};
  }

  // No value without a standard deviation, nor the other way round.
  static Quantity<Scalar> quantity(const Filter& filter, StateIndex i, Provenance provenance) {
    const Scalar variance = filter.P(i, i);
    if (!std::isfinite(filter.x[i]) || !std::isfinite(variance) || variance < Scalar(0)) return {};
    return {filter.x[i], std::sqrt(variance), provenance};
  }

  // `is_measured`: stage 1 was updated in this step; a prediction alone is assumed.
  Estimate current_estimate(bool is_measured) {
    Estimate estimate;
    Provenance motion_provenance[3];
    for (int i = 0; i < 3; ++i) {
      motion_provenance[i] =
          is_measured ? provenance_of_share(information_share(motion_.P(i, i), motion_prior_(i, i)))
                      : Provenance::assumed;
    }
    // The force is the measured acceleration times the assumed mass.
    const Provenance force_provenance = motion_provenance[kThird] == Provenance::measured
                                            ? Provenance::derived
                                            : Provenance::assumed;
    estimate.position_m = quantity(motion_, kPosition, motion_provenance[kPosition]);
    estimate.velocity_m_s = quantity(motion_, kVelocity, motion_provenance[kVelocity]);
    estimate.force_N = quantity(motion_, kThird, force_provenance);
    estimate.friction_Ns_m = quantity(friction_, kThird, Provenance::assumed);
    estimate.mass_kg = quantity(mass_, kThird, Provenance::assumed);
    for (const Filter* filter : {&motion_, &friction_, &mass_}) {
      for (int i = 0; i < 3; ++i) {
        estimate.events.add(Event::estimate_not_finite,
                            !std::isfinite(filter->x[i]) || !std::isfinite(filter->P(i, i)));
        estimate.events.add(Event::variance_negative, filter->P(i, i) < Scalar(0));
      }
    }
    estimate.verdict = matching_.add(mass_.x[kThird], assumed_mass_kg_);
    return estimate;
  }

  static Estimate invalid_estimate() {
    Estimate estimate;
    estimate.events.add(Event::parameters_invalid);
    return estimate;
  }

  Scalar sample_time_s_, assumed_mass_kg_, initial_friction_Ns_m_, initial_mass_kg_;
  Discretisation discretisation_;
  StageNoise motion_noise_, friction_noise_, mass_noise_;
  bool parameters_valid_;
  bool started_ = false;
  Filter motion_, friction_, mass_;
  // Covariance that prior and process noise alone would give stage 1.
  SymmetricMatrix3<Scalar> motion_prior_;
  MatchingCriterion matching_;
};

}  // namespace condyle
