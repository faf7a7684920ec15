// SPDX-License-Identifier: Apache-2.0
// A simulated facebow and its companions (force sensor, EMG amplifier, accelerometer on the head),
// with realistic faults.
//
// The facebow sees the pose of a rigid body on the lower teeth and reports three virtual points of
// it, (0,0,0), (25,0,30) and (-25,0,30) mm in the body, so a single 6-DoF noise moves all three and
// their distances never change.
//
// Order of what happens to a sample: true pose at its instant (rate, jitter) -> noise -> the
// manufacturer's smoothing -> glitch, freeze or zero-filled dropout -> quantisation -> device time
// (clock drift, latency) -> lost or repeated.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "condyle/estimator/sample.h"
#include "simulation/subject.h"
#include "statistics/random.h"

namespace condyle::host {

/// An interval of time, the same in every run.
struct Stretch {
  double start_s = 0;
  double duration_s = 0;  ///< 0: none
  bool contains(double time_s) const {
    return duration_s > 0 && time_s >= start_s && time_s < start_s + duration_s;
  }
};

/// The facebow.
struct FacebowModel {
  double rate_Hz = 60;
  double jitter_s = 0;        ///< standard deviation of the sampling instant, not reported
  double clock_drift = 0;     ///< relative: the device's clock runs fast
  double latency_s = 0;       ///< the reported time is that much after the instant
  double noise_m = 5e-5;      ///< standard deviation of each of three translations
  double noise_rad = 3e-4;    ///< of each of three rotations
  double smoothing = 0;       ///< share of the previous output in each (first-order filter)
  double quantum_m = 0;       ///< coordinates are multiples of it; 0: none
  double lost_share = 0;      ///< of samples
  double repeated_share = 0;  ///< of samples, reported twice
  double glitch_share = 0;    ///< of samples, thrown 3-8 mm off in a random direction
  Stretch dropout;            ///< filled with zeros
  Stretch frozen;             ///< repeats the last pose at new times
  bool gives_points = true;   ///< three points; else the followed axis alone
};

/// A force sensor on the followed axis.
struct DriveModel {
  double rate_Hz = 0;  ///< 0: none
  double noise_N = 0.01;
  double gain = 1;           ///< shown force as a share of the true force
  double missing_share = 0;  ///< share of the muscles' force that it does not measure
  /// Part of the muscles' force in phase with velocity that it does not measure: force per
  /// velocity.
  double missing_in_phase_Ns_m = 0;
  double delay_s = 0;
};

/// An EMG amplifier: envelopes of the muscles' excitations, 0 to 1.
struct EmgModel {
  double rate_Hz = 0;  ///< 0: none
  double noise = 0.02;
  double gain = 1;
  double missing_share = 0;  ///< of the excitation that the electrodes do not record
  double delay_s = 0;
};

/// An accelerometer on the head, along the followed axis. The driving force of the jaw is its
/// inertia in the moving head, so the acceleration is minus this force over the jaw's mass, plus
/// gravity.
struct HeadModel {
  double rate_Hz = 0;  ///< 0: none
  double noise_m_s2 = 0.05;
  double gain = 1;  ///< shown acceleration as a share of the true one
  double delay_s = 0;
};

/// The points that the facebow reports, in the frame of the body (m).
inline constexpr std::array<double, 3> kFacebowPoints_m[3] = {
    {0, 0, 0}, {0.025, 0, 0.030}, {-0.025, 0, 0.030}};

/// True pose of the body that the facebow sees, relative to its rest pose.
struct Pose {
  std::array<double, 3> translation_m{};  ///< x right, y forward, z up
  std::array<double, 3> rotation_rad{};   ///< small rotations about x, y, z
};

/// When the facebow samples, and what goes wrong on the way from a pose to the samples, whatever
/// the pose is.
class FacebowFaults {
 public:
  FacebowFaults(const FacebowModel& model, std::uint64_t seed);

  /// Instant of the next sample (s). It changes with `deliver`.
  double next_instant_s() const { return next_instant_s_; }
  bool is_frozen() const { return model_.frozen.contains(next_instant_s_); }
  /// Draws whether this sample is thrown off, and where to.
  std::optional<std::array<double, 3>> draw_glitch_m();
  /// A coordinate as the facebow shows it: quantised, 0 in a dropout.
  double shown_m(double value_m) const;
  /// Completes `sample`, whose kind and coordinates are set, and appends it: never if it is lost,
  /// twice if it is repeated.
  void deliver(Sample& sample, std::vector<Sample>& samples);

 private:
  void schedule();

  FacebowModel model_;
  RandomGenerator faults_, times_;
  std::uint64_t count_ = 0;
  double next_instant_s_ = 0;
};

/// The facebow: called once for each true sampling instant, in order.
class SimulatedFacebow {
 public:
  SimulatedFacebow(const FacebowModel& model, Axis translation_axis, std::uint64_t seed);

  /// Instant of the next sample (s).
  double next_instant_s() const { return faults_.next_instant_s(); }
  /// Takes the subject's state at that instant; appends its samples (none when lost, two when
  /// repeated) to `samples`.
  void sample(const Jaw& jaw, double coordinate, std::vector<Sample>& samples);

 private:
  Pose true_pose(const Jaw& jaw, double coordinate) const;

  FacebowModel model_;
  Axis axis_;
  RandomGenerator noise_;
  FacebowFaults faults_;
  std::optional<Pose> smoothed_, shown_;
};

}  // namespace condyle::host
