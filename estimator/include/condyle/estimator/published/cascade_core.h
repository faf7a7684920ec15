// SPDX-License-Identifier: Apache-2.0
// The arithmetic of the published cascade: three extended Kalman filters per sample, in this order.
//
//   stage 1 motion    (p, v, F)   measures z             no input          motion_stage.h
//   stage 2 friction  (p, v, kv)  measures z and v of 1  u = F of 1        friction_stage.h
//   stage 3 mass      (p, v, m)   measures z and v of 1  u = F of 1, kv of 2  mass_stage.h
//
// The first sample initialises (p = z, v = 0, F = 0, kv and m from the parameters) and is taken as
// a measurement, without prediction.
//
// No standard deviations, provenance or verdict: published_cascade.h adds them. Each filter is
// copied, stepped and copied back, so that the copy stays in registers between its updates. Rare
// cases (the first sample, an unused measurement) are handled by a call at the end, so that they
// cost no registers.
#pragma once

#include "condyle/estimator/published/friction_stage.h"
#include "condyle/estimator/published/mass_stage.h"
#include "condyle/estimator/published/motion_stage.h"
#include "condyle/estimator/published/parameters.h"

namespace condyle {

/// What a step of the core computes besides the estimates.
enum class CoreChecks {
  none,          ///< nothing
  nis_and_gate,  ///< each stage's normalised innovation squared, and stage 1's against a gate
};

/// Gate that rejects no measurement.
template <class Scalar>
inline constexpr Scalar kNoGate = std::numeric_limits<Scalar>::infinity();

/// Results of one step with `CoreChecks::nis_and_gate`. NaN if there is no value.
template <class Scalar>
struct CoreStep {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::quiet_NaN();

  Scalar innovation_m = kNone;  ///< measured minus predicted position, stage 1
  Scalar motion_nis = kNone;    ///< of stage 1: chi-square with 1 degree of freedom
  Scalar friction_nis = kNone;  ///< of stage 2: 2 degrees of freedom
  Scalar mass_nis = kNone;      ///< of stage 3: 2 degrees of freedom
  bool motion_updated = false;  ///< stage 1 used the measurement
  /// an innovation variance was not positive and finite: that stage and those after it only predict
  bool refused = false;
  bool rejected = false;  ///< stage 1's NIS was above the gate: all stages only predicted
};

/// The three filters of the published cascade for one axis, and their order of calls.
template <class Scalar>
class CascadeCore {
 public:
  using Filter = ThreeStateFilter<Scalar>;

  /// `parameters` must satisfy `is_valid`. `gate`: largest NIS of stage 1 that is accepted
  /// (chi-square with 1 degree of freedom: 6.63 rejects 1 % of good measurements, if their variance
  /// is right).
  explicit CascadeCore(const PublishedParameters& parameters, Scalar gate = kNoGate<Scalar>)
      : assumed_mass_kg_(static_cast<Scalar>(parameters.assumed_mass_kg)),
        initial_friction_Ns_m_(static_cast<Scalar>(parameters.friction.initial_Ns_m)),
        initial_mass_kg_(static_cast<Scalar>(parameters.mass.initial_kg)),
        gate_(gate),
        discretisation_(parameters.motion.discretisation),
        motion_noise_(parameters.motion),
        friction_noise_(parameters.friction),
        mass_noise_(parameters.mass) {}

  /// Advances by `time_step_s` with the measured position (m, finite). The process variances are
  /// those of one step, whatever its length. Returns true if every measurement was used; with
  /// `CoreChecks::nis_and_gate`, a CoreStep. Flattened, so that the limits on inlining in a large
  /// program do not make it slower.
  template <CoreChecks checks = CoreChecks::none>
  [[gnu::flatten]] auto step(Scalar measured_position_m, Scalar time_step_s) {
    if (!started_) [[unlikely]]
      return first_step<checks>(measured_position_m);
    return advance<checks, true>(measured_position_m, time_step_s);
  }

  /// Advances by `time_step_s` without a measurement: all stages predict, none updates. Requires a
  /// first measurement.
  void predict(Scalar time_step_s) {
    predict_motion(motion_, time_step_s);
    predict_friction(friction_, time_step_s);
    predict_mass(mass_, time_step_s);
  }

  /// `covariance` of (p, v, F) one step on by stage 1's model, without a measurement.
  [[gnu::always_inline]] void propagate_motion(SymmetricMatrix3<Scalar>& covariance,
                                               Scalar time_step_s) const {
    propagate_motion_covariance(covariance, time_step_s, assumed_mass_kg_, discretisation_,
                                motion_noise_.Q);
  }

  /// True from the first measurement on.
  bool started() const { return started_; }
  /// Variances of stage 1's first state (units of (p, v, F) squared).
  const Vector3<Scalar>& initial_motion_variance() const { return motion_noise_.initial; }
  /// Mass that turns acceleration into force (kg).
  Scalar assumed_mass_kg() const { return assumed_mass_kg_; }
  /// Stage 1: position (m), velocity (m/s), net force (N).
  const Filter& motion() const { return motion_; }
  /// Stage 2: position (m), velocity (m/s), friction (Ns/m).
  const Filter& friction() const { return friction_; }
  /// Stage 3: position (m), velocity (m/s), mass (kg).
  const Filter& mass() const { return mass_; }

 private:
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

  void start(Scalar z) {
    motion_.initialise({z, 0, 0}, motion_noise_.initial);
    friction_.initialise({z, 0, initial_friction_Ns_m_}, friction_noise_.initial);
    mass_.initialise({z, 0, initial_mass_kg_}, mass_noise_.initial);
    started_ = true;
  }

  template <CoreChecks checks>
  [[gnu::noinline]] auto first_step(Scalar z) {
    start(z);
    return advance<checks, false>(z, Scalar(0));
  }

  // One step; the first sample is used without a prediction: then `moves` is false.
  template <CoreChecks checks, bool moves>
  [[gnu::always_inline]] auto advance(Scalar z, Scalar T) {
    Filter motion = motion_;
    if constexpr (moves) predict_motion(motion, T);
    const Scalar innovation = z - motion.x[kPosition];
    if constexpr (checks == CoreChecks::nis_and_gate) {
      if (motion.template nis_of<kPosition>(z, motion_noise_.R[0]) > gate_) [[unlikely]] {
        return only_predict<checks, moves>(1, true, T, innovation);
      }
    }
    const auto position = motion.template update<kPosition>(z, motion_noise_.R[0]);
    if (position.refused) [[unlikely]] {
      return only_predict<checks, moves>(1, false, T, innovation);
    }
    motion_ = motion;
    const Scalar v = motion.x[kVelocity];

    Filter friction = friction_;
    if constexpr (moves) predict_friction(friction, T);
    const auto friction_z = friction.template update<kPosition>(z, friction_noise_.R[0]);
    if (friction_z.refused) [[unlikely]] {
      return only_predict<checks, moves>(2, false, T, innovation, position.nis);
    }
    const auto friction_v = friction.template update<kVelocity>(v, friction_noise_.R[1]);
    if (friction_v.refused) [[unlikely]] {
      return only_predict<checks, moves>(2, false, T, innovation, position.nis);
    }
    friction_ = friction;
    const Scalar friction_nis = friction_z.nis + friction_v.nis;

    Filter mass = mass_;
    if constexpr (moves) predict_mass(mass, T);
    const auto mass_z = mass.template update<kPosition>(z, mass_noise_.R[0]);
    if (mass_z.refused) [[unlikely]] {
      return only_predict<checks, moves>(3, false, T, innovation, position.nis, friction_nis);
    }
    const auto mass_v = mass.template update<kVelocity>(v, mass_noise_.R[1]);
    if (mass_v.refused) [[unlikely]] {
      return only_predict<checks, moves>(3, false, T, innovation, position.nis, friction_nis);
    }
    mass_ = mass;

    if constexpr (checks == CoreChecks::none) {
      return true;
    } else {
      return CoreStep<Scalar>{innovation, position.nis, friction_nis, mass_z.nis + mass_v.nis,
                              true,       false,        false};
    }
  }

  // The rest of a step from `stage` on (1 to 3), without updates.
  template <CoreChecks checks, bool moves>
  [[gnu::noinline]] auto only_predict(int stage, bool rejected, Scalar T, Scalar innovation,
                                      Scalar motion_nis = CoreStep<Scalar>::kNone,
                                      Scalar friction_nis = CoreStep<Scalar>::kNone) {
    if constexpr (moves) {
      if (stage <= 1) predict_motion(motion_, T);
      if (stage <= 2) predict_friction(friction_, T);
      predict_mass(mass_, T);
    }
    if constexpr (checks == CoreChecks::none) {
      return false;
    } else {
      return CoreStep<Scalar>{innovation, motion_nis, friction_nis, CoreStep<Scalar>::kNone,
                              stage > 1,  !rejected,  rejected};
    }
  }

  // Stages 2 and 3 predict with the present values of the stages before.
  [[gnu::always_inline]] void predict_motion(Filter& motion, Scalar T) const {
    motion.x = motion_transition(motion.x, T, assumed_mass_kg_, discretisation_).state;
    propagate_motion(motion.P, T);
  }
  [[gnu::always_inline]] void predict_friction(Filter& friction, Scalar T) const {
    const Scalar u = motion_.x[kThird];
    friction.predict_backward(friction_transition(friction.x, u, T, assumed_mass_kg_), T,
                              friction_noise_.Q);
  }
  [[gnu::always_inline]] void predict_mass(Filter& mass, Scalar T) const {
    const Scalar u = motion_.x[kThird], kv = friction_.x[kThird];
    mass.predict_backward(mass_transition(mass.x, u, kv, T), T, mass_noise_.Q);
  }

  Scalar assumed_mass_kg_, initial_friction_Ns_m_, initial_mass_kg_, gate_;
  Discretisation discretisation_;
  StageNoise motion_noise_, friction_noise_, mass_noise_;
  bool started_ = false;
  Filter motion_, friction_, mass_;
};

}  // namespace condyle
