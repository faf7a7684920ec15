// SPDX-License-Identifier: Apache-2.0
#include "simulation/instrument.h"

#include <cmath>
#include <numbers>

#include "condyle/estimator/math/elementary.h"

namespace condyle::host {
namespace {

using Vector = std::array<double, 3>;

constexpr double kSmallestGlitch_m = 0.003, kLargestGlitch_m = 0.008;

// Rotated about x, then y, then z: an exact rotation of any size.
Vector turn(Vector point, const Vector& angles) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t j = (axis + 1) % 3, k = (axis + 2) % 3;
    const double s = elementary::sin(angles[axis]), c = elementary::cos(angles[axis]);
    const double pj = point[j], pk = point[k];
    point[j] = c * pj - s * pk;
    point[k] = s * pj + c * pk;
  }
  return point;
}

Pose blend(const Pose& previous, const Pose& now, double share_of_previous) {
  Pose result;
  for (std::size_t i = 0; i < 3; ++i) {
    result.translation_m[i] = share_of_previous * previous.translation_m[i] +
                              (1 - share_of_previous) * now.translation_m[i];
    result.rotation_rad[i] = share_of_previous * previous.rotation_rad[i] +
                             (1 - share_of_previous) * now.rotation_rad[i];
  }
  return result;
}

}  // namespace

FacebowFaults::FacebowFaults(const FacebowModel& model, std::uint64_t seed)
    : model_(model), faults_(seed, 2), times_(seed, 3) {
  schedule();
}

void FacebowFaults::schedule() {
  const double jitter_s = model_.jitter_s * times_.normal();
  next_instant_s_ =
      std::max(next_instant_s_, static_cast<double>(count_) / model_.rate_Hz + jitter_s);
}

std::optional<Vector> FacebowFaults::draw_glitch_m() {
  if (faults_.uniform() >= model_.glitch_share) return std::nullopt;
  const double size_m =
      kSmallestGlitch_m + (kLargestGlitch_m - kSmallestGlitch_m) * faults_.uniform();
  const double height = 2 * faults_.uniform() - 1, angle = 2 * std::numbers::pi * faults_.uniform();
  const double across = std::sqrt(1 - height * height);
  return Vector{size_m * across * elementary::cos(angle), size_m * across * elementary::sin(angle),
                size_m * height};
}

double FacebowFaults::shown_m(double value_m) const {
  if (model_.dropout.contains(next_instant_s_)) return 0;
  if (model_.quantum_m <= 0) return value_m;
  return std::floor(value_m / model_.quantum_m + 0.5) * model_.quantum_m;
}

void FacebowFaults::deliver(Sample& sample, std::vector<Sample>& samples) {
  sample.sequence = count_;
  // The device assumes regular sampling; it does not report the jitter.
  const double regular_s = static_cast<double>(count_) / model_.rate_Hz;
  sample.time_ns = nanoseconds(regular_s * (1 + model_.clock_drift) + model_.latency_s);
  sample.position_valid = !is_out_of_range(sample.kind, sample.coordinates);
  const bool is_lost = faults_.uniform() < model_.lost_share;
  const bool is_repeated = faults_.uniform() < model_.repeated_share;
  if (!is_lost) samples.push_back(sample);
  if (!is_lost && is_repeated) samples.push_back(sample);
  ++count_;
  schedule();
}

SimulatedFacebow::SimulatedFacebow(const FacebowModel& model, Axis translation_axis,
                                   std::uint64_t seed)
    : model_(model), axis_(translation_axis), noise_(seed, 1), faults_(model, seed) {}

Pose SimulatedFacebow::true_pose(const Jaw& jaw, double coordinate) const {
  Pose pose;
  if (jaw.motion == JawMotion::translation) {
    pose.translation_m[static_cast<std::size_t>(axis_)] = coordinate;
    return pose;
  }
  // The incisor point rotates about the TMJ axis, which is parallel to x; opening moves it down.
  const double phi = jaw.incisor_angle_rad - coordinate;
  pose.translation_m[1] =
      jaw.incisor_radius_m * (elementary::cos(phi) - elementary::cos(jaw.incisor_angle_rad));
  pose.translation_m[2] = jaw.followed_position_m(coordinate);
  pose.rotation_rad[0] = -coordinate;
  return pose;
}

void SimulatedFacebow::sample(const Jaw& jaw, double coordinate, std::vector<Sample>& samples) {
  Pose pose = true_pose(jaw, coordinate);
  for (double& value : pose.translation_m) value += model_.noise_m * noise_.normal();
  for (double& value : pose.rotation_rad) value += model_.noise_rad * noise_.normal();
  if (smoothed_) pose = blend(*smoothed_, pose, model_.smoothing);
  smoothed_ = pose;
  if (const auto glitch_m = faults_.draw_glitch_m()) {
    for (std::size_t i = 0; i < 3; ++i) pose.translation_m[i] += (*glitch_m)[i];
  }
  if (faults_.is_frozen() && shown_) pose = *shown_;
  shown_ = pose;

  Sample sample;
  if (model_.gives_points) {
    sample.kind = SampleKind::three_points;
    for (std::size_t point = 0; point < 3; ++point) {
      const Vector turned = turn(kFacebowPoints_m[point], pose.rotation_rad);
      for (std::size_t i = 0; i < 3; ++i) {
        sample.coordinates[3 * point + i] = faults_.shown_m(turned[i] + pose.translation_m[i]);
      }
    }
  } else {
    const Axis followed = jaw.motion == JawMotion::hinge ? Axis::z : axis_;
    sample.coordinates[0] = faults_.shown_m(pose.translation_m[static_cast<std::size_t>(followed)]);
  }
  faults_.deliver(sample, samples);
}

}  // namespace condyle::host
