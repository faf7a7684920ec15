// SPDX-License-Identifier: Apache-2.0
// The whole pose of the jaw from measured poses: position, orientation and their rates, of which
// any jaw-fixed point and any axis have a part (pose_estimate.h).
//
//   c        the body's centre R b_c + t (m)
//   w        rotation vector of R R_0' (rad), R_0 the reference orientation: the first measured one
//            unless it is set
//   L        length 0.1 m, which makes w a displacement: that of a point so far from the axis
//
// Two recommended estimators (recommended_estimator.h), of c and of L w, with the same parameters,
// times and lag; the first guess of the noise is L rotation_sd_rad for L w. Limits of noise, the
// prior of velocity and so on hold for L w in metres.
//
// One decision for both. Each is first asked whether it expects the sample (sample_forecast.h). If
// only one does not, it alone is given the sample, to explain it as an outlier or a change; the
// other predicts across it. So a glitch that shows in the position alone does not enter the
// orientation, nor the other way round. What this does not undo is a sample that both expect and
// one finds out later (`outlier_revoked`).
//
// A pose turned by more than kFarthestTurn_rad from the reference is not used: near a half turn the
// rotation vector jumps. The event is `position_missing`.
//
// Turning the instrument's frame turns the estimates with it exactly if adaptation is off and no
// sample is unexpected. With adaptation on, noise and jerk density are learned axis by axis, so
// that only exchanging or reversing axes does.
#pragma once

#include "condyle/estimator/motion/recommended_estimator.h"
#include "condyle/estimator/pose/pose_estimate.h"
#include "condyle/estimator/pose/sample_forecast.h"

namespace condyle {

/// L: turns a rotation vector (rad) into a displacement (m).
inline constexpr double kTurnLength_m = 0.1;
/// Largest turn from the reference orientation that is used (rad).
inline constexpr double kFarthestTurn_rad = 2.5;

/// A measured pose and its time.
template <class Scalar>
struct TimedPose {
  TimeNs time_ns = 0;
  bool is_measured = false;  ///< false: the pose is missing, and the filters only predict
  Pose<Scalar> pose;
  EventSet events;         ///< unusual properties of the sample; passed on
  bool is_repeat = false;  ///< every coordinate repeats the last sample's, bit for bit
};

/// See the model above. Estimates are `lag` samples late, at most `kMostLag`. One object per run;
/// copying it copies the run.
template <class Scalar, int kMostLag = 16>
class PoseEstimator {
 public:
  using Estimate = PoseEstimate<Scalar>;
  using Measurement = TimedPose<Scalar>;
  using Part = RecommendedEstimator<Scalar, 3, kMostLag>;

  /// Parameters and lag as for RecommendedEstimator.
  explicit PoseEstimator(const MotionEstimatorParameters& parameters, int lag = 0)
      : longest_gap_s_(static_cast<Scalar>(parameters.outliers.longest_gap_s)),
        gate_(parameters.outliers),
        centre_(parameters, lag),
        turn_(parameters, lag) {
    const auto sd_m = static_cast<Scalar>(std::max(kTurnLength_m * parameters.noise.rotation_sd_rad,
                                                   parameters.noise.lowest_position_sd_m));
    turn_.estimator.set_noise({sd_m, sd_m, sd_m});
  }

  /// The reference orientation, before the first measurement.
  void set_reference(const Matrix3<Scalar>& rotation) {
    reference_ = rotation;
    has_reference_ = true;
  }

  /// The point of the jaw frame that the instrument measures best (m), before the first
  /// measurement; the origin unless it is set.
  void set_body_centre(const Vector3<Scalar>& body_centre_m) { body_centre_m_ = body_centre_m; }

  /// The next sample, whose time is known; as RecommendedEstimator::step. A pose that is not finite
  /// enters no state.
  Estimate step(const Measurement& measurement) {
    const bool is_reversed = has_time_ && measurement.time_ns < time_ns_;
    const Scalar T =
        has_time_ && !is_reversed ? difference_s<Scalar>(measurement.time_ns, time_ns_) : Scalar(0);
    TimedPosition<Scalar, 3> of_centre = without_position(measurement), of_turn = of_centre;
    if (measurement.is_measured && !is_reversed) {
      locate(measurement.pose, of_centre, of_turn);
      if (of_centre.is_measured) agree(T, of_centre, of_turn);
    }
    if (!is_reversed) {
      time_ns_ = measurement.time_ns;
      has_time_ = true;
    }
    return combined(centre_.estimator.step(of_centre), turn_.estimator.step(of_turn));
  }

  /// As RecommendedEstimator::skip.
  Estimate skip(const Measurement& measurement, bool time_valid) {
    const TimedPosition<Scalar, 3> position = without_position(measurement);
    return combined(centre_.estimator.skip(position, time_valid),
                    turn_.estimator.skip(position, time_valid));
  }

  /// As RecommendedEstimator::restart_clock.
  void restart_clock() {
    has_time_ = centre_.is_given = turn_.is_given = false;
    centre_.estimator.restart_clock();
    turn_.estimator.restart_clock();
  }

  /// As RecommendedEstimator::forget_frozen.
  void forget_frozen(int samples) {
    centre_.is_given = turn_.is_given = false;
    centre_.estimator.forget_frozen(samples);
    turn_.estimator.forget_frozen(samples);
  }

  /// As RecommendedEstimator::drain.
  [[nodiscard]] bool drain(Estimate& estimate) {
    RecommendedEstimate<Scalar> of_centre, of_turn;
    if (!centre_.estimator.drain(of_centre) || !turn_.estimator.drain(of_turn)) return false;
    estimate = combined(of_centre, of_turn);
    return true;
  }

  /// Poses that were turned too far from the reference to be used.
  std::uint64_t far_turned() const { return far_turned_; }
  /// The reference orientation; valid once there was a measurement, or it was set.
  const Matrix3<Scalar>& reference() const { return reference_; }
  /// The estimator of the centre (m).
  const Part& centre() const { return centre_.estimator; }
  /// The estimator of L w (m).
  const Part& turn() const { return turn_.estimator; }

 private:
  static constexpr Scalar kLength_m = Scalar(kTurnLength_m);

  // An estimator, and when it was last given a position.
  struct Half {
    explicit Half(const MotionEstimatorParameters& parameters, int lag)
        : estimator(parameters, lag) {}
    Part estimator;
    bool is_given = false;
    TimeNs given_ns = 0;
  };

  static TimedPosition<Scalar, 3> without_position(const Measurement& measurement) {
    TimedPosition<Scalar, 3> position;
    position.time_ns = measurement.time_ns;
    position.events = measurement.events;
    position.is_repeat = measurement.is_repeat;
    return position;
  }

  // Centre and turn of `pose`, unless it is unusable.
  void locate(const Pose<Scalar>& pose, TimedPosition<Scalar, 3>& of_centre,
              TimedPosition<Scalar, 3>& of_turn) {
    const Vector3<Scalar> centre_m = point_of(pose, body_centre_m_);
    bool is_usable = centre_m.allFinite() && pose.rotation.allFinite();
    Vector3<Scalar> turn_rad = Vector3<Scalar>::Zero();
    if (is_usable) {
      if (!has_reference_) set_reference(pose.rotation);
      turn_rad = rotation_vector_of(Matrix3<Scalar>(pose.rotation * reference_.transpose()));
      is_usable = turn_rad.norm() <= Scalar(kFarthestTurn_rad);
      far_turned_ += is_usable ? 0U : 1U;
    }
    for (auto* const part : {&of_centre, &of_turn}) {
      part->is_measured = is_usable;
      part->events.add(Event::position_missing, !is_usable);
    }
    for (int axis = 0; axis < 3; ++axis) {
      of_centre.position_m[axis] = centre_m[axis];
      of_turn.position_m[axis] = kLength_m * turn_rad[axis];
    }
  }

  // A sample that only one of the two does not expect is given to that one alone.
  void agree(Scalar T, TimedPosition<Scalar, 3>& of_centre, TimedPosition<Scalar, 3>& of_turn) {
    const bool centre_is_odd = is_unexpected(centre_, T, of_centre);
    const bool turn_is_odd = is_unexpected(turn_, T, of_turn);
    of_centre.is_measured = centre_is_odd || !turn_is_odd;
    of_turn.is_measured = turn_is_odd || !centre_is_odd;
    for (const auto& [half, part] : {std::pair{&centre_, &of_centre}, {&turn_, &of_turn}}) {
      if (!part->is_measured) continue;
      half->is_given = true;
      half->given_ns = part->time_ns;
    }
  }

  bool is_unexpected(const Half& half, Scalar T, const TimedPosition<Scalar, 3>& position) const {
    if (!half.is_given) return false;
    if (difference_s<Scalar>(position.time_ns, half.given_ns) > longest_gap_s_) return false;
    return foresees_outlier(half.estimator.motion(), position.position_m, T, gate_);
  }

  Estimate combined(const RecommendedEstimate<Scalar>& of_centre,
                    const RecommendedEstimate<Scalar>& of_turn) const {
    Estimate estimate;
    estimate.is_ready = of_centre.is_ready;
    estimate.time_ns = of_centre.time_ns;
    estimate.time_valid = of_centre.time_valid;
    estimate.events = of_centre.events;
    estimate.events.add(of_turn.events);
    estimate.nis = of_centre.nis + of_turn.nis;
    estimate.body_centre_m = body_centre_m_;
    VectorEstimate<Scalar> turn_rate;
    gather(of_centre, Scalar(1), estimate.centre_m, estimate.centre_velocity_m_s);
    gather(of_turn, kLength_m, estimate.rotation_vector_rad, turn_rate);
    // Beyond a half turn, where only a prediction leads, the vector is none of a rotation.
    if (!(estimate.rotation_vector_rad.value.norm() <= Scalar(3.14159))) {
      estimate.rotation_vector_rad = {};
    }
    take_weaker(estimate.centre_m, estimate.rotation_vector_rad);
    if (estimate.provenance() == Provenance::not_computed) turn_rate = {};
    take_weaker(estimate.centre_velocity_m_s, turn_rate);
    if (estimate.provenance() == Provenance::not_computed) return estimate;
    const Vector3<Scalar>& w = estimate.rotation_vector_rad.value;
    const Matrix3<Scalar> J = left_jacobian(w);
    estimate.rotation = rotation_of(w) * reference_;
    estimate.rotation_covariance_rad2 = J * estimate.rotation_vector_rad.covariance * J.transpose();
    if (turn_rate.provenance == Provenance::not_computed) return estimate;
    estimate.angular_velocity_rad_s = {
        J * turn_rate.value, J * turn_rate.covariance * J.transpose(), turn_rate.provenance};
    return estimate;
  }

  // Position and velocity of all axes, divided by `length_m`; empty if an axis has none.
  static void gather(const RecommendedEstimate<Scalar>& part, Scalar length_m,
                     VectorEstimate<Scalar>& position, VectorEstimate<Scalar>& velocity) {
    gather(part, &AxisEstimate<Scalar>::position_m, length_m, position);
    gather(part, &AxisEstimate<Scalar>::velocity_m_s, length_m, velocity);
  }
  static void gather(const RecommendedEstimate<Scalar>& part,
                     Quantity<Scalar> AxisEstimate<Scalar>::*quantity, Scalar length_m,
                     VectorEstimate<Scalar>& gathered) {
    Provenance weakest = Provenance::measured;
    Vector3<Scalar> value, sd;
    for (int axis = 0; axis < 3; ++axis) {
      const Quantity<Scalar>& one = part.axes[axis].*quantity;
      weakest = std::min(weakest, one.provenance);
      value[axis] = one.value / length_m;
      sd[axis] = one.standard_deviation / length_m;
    }
    if (weakest == Provenance::not_computed) return;
    gathered = {value, sd.cwiseAbs2().asDiagonal(), weakest};
  }

  // Both get the weaker provenance; without one of them there is neither.
  static void take_weaker(VectorEstimate<Scalar>& a, VectorEstimate<Scalar>& b) {
    const Provenance weaker = std::min(a.provenance, b.provenance);
    for (auto* const each : {&a, &b}) {
      if (weaker == Provenance::not_computed) *each = {};
      each->provenance = weaker;
    }
  }

  Scalar longest_gap_s_;
  OutlierGate<Scalar> gate_;
  Half centre_, turn_;
  bool has_reference_ = false, has_time_ = false;
  TimeNs time_ns_ = 0;
  std::uint64_t far_turned_ = 0;
  Matrix3<Scalar> reference_ = Matrix3<Scalar>::Identity();
  Vector3<Scalar> body_centre_m_ = Vector3<Scalar>::Zero();
};

}  // namespace condyle
