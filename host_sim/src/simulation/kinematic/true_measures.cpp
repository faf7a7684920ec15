// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/true_measures.h"

namespace condyle::host::truth {

double greatest(const Function& value, const Span& span) {
  double most = value(span.begin_s);
  at_instants(span, [&](double time_s) { most = std::max(most, value(time_s)); });
  return most;
}

double greatest_at_s(const Function& value, const Span& span) {
  double most = value(span.begin_s), where_s = span.begin_s;
  at_instants(span, [&](double time_s) {
    const double now = value(time_s);
    if (now > most) {
      most = now;
      where_s = time_s;
    }
  });
  return where_s;
}

std::optional<double> first_passage_s(const Function& value, const Span& span, double level) {
  double before_s = span.begin_s;
  std::optional<double> after_s;
  at_instants(span, [&](double time_s) {
    if (after_s) return;
    if (value(time_s) >= level) {
      after_s = time_s;
    } else {
      before_s = time_s;
    }
  });
  if (!after_s) return std::nullopt;
  double late_s = *after_s;
  for (int i = 0; i < 50; ++i) {
    const double middle_s = (before_s + late_s) / 2;
    (value(middle_s) >= level ? late_s : before_s) = middle_s;
  }
  return late_s;
}

Eigen::Vector3d displacement_mm(const JawPose& pose, const Eigen::Vector3d& point_m) {
  return 1e3 * (pose.rotation * point_m + pose.translation_m - point_m);
}

// Twist about Y: 2 atan2(q_y, q_w). With q_w = sqrt(1 + trace)/2, 4 q_w q_y = R_13 - R_31.
double opening_angle_deg(const Eigen::Matrix3d& rotation) {
  return 2 * kDegrees * std::atan2(rotation(0, 2) - rotation(2, 0), 1 + rotation.trace());
}

}  // namespace condyle::host::truth
