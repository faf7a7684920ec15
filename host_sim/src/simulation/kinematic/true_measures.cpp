// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/true_measures.h"

#include <complex>
#include <vector>

namespace condyle::host::truth {
namespace {

double sparc(const std::vector<double>& speeds) {
  const double count = std::exp2(std::ceil(std::log2(static_cast<double>(speeds.size()))) + 4);
  const double frequency_Hz = 1 / (kStep_s * count);
  std::vector<double> amplitudes;
  for (double k = 0; k * frequency_Hz <= 10; ++k) {
    const std::complex<double> turn = std::polar(1.0, -2 * std::numbers::pi * k / count);
    std::complex<double> sum = 0, phase = 1;
    for (const double speed : speeds) {
      sum += speed * phase;
      phase *= turn;
    }
    amplitudes.push_back(std::abs(sum));
  }
  const double most = *std::max_element(amplitudes.begin(), amplitudes.end());
  std::size_t last = amplitudes.size() - 1;
  while (last > 0 && amplitudes[last] < 0.05 * most) --last;
  double length = 0;
  for (std::size_t k = 1; k <= last; ++k) {
    length += std::hypot(1 / static_cast<double>(last), (amplitudes[k] - amplitudes[k - 1]) / most);
  }
  return -length;
}

double ldlj(const std::vector<double>& speeds, double peak) {
  double sum = 0;
  for (std::size_t k = 1; k + 1 < speeds.size(); ++k) {
    const double jerk = (speeds[k + 1] - 2 * speeds[k] + speeds[k - 1]) / (kStep_s * kStep_s);
    sum += jerk * jerk * kStep_s;
  }
  const double duration_s = static_cast<double>(speeds.size()) * kStep_s;
  return -std::log(std::pow(duration_s, 3) / (peak * peak) * sum);
}

}  // namespace

TrueSmoothness smoothness(const Function& speed, const Span& span, double least_share) {
  std::vector<double> speeds;
  for (double time_s = span.begin_s; time_s <= span.end_s; time_s += kStep_s) {
    speeds.push_back(speed(time_s));
  }
  const auto peak = std::max_element(speeds.begin(), speeds.end());
  const double greatest = *peak;
  auto begin = peak, end = peak;
  while (begin != speeds.begin() && *(begin - 1) >= least_share * greatest) --begin;
  while (end != speeds.end() && *end >= least_share * greatest) ++end;
  speeds = std::vector<double>(begin, end);
  return {sparc(speeds), ldlj(speeds, greatest)};
}

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
