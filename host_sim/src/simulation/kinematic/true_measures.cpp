// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/true_measures.h"

#include <complex>
#include <vector>

namespace condyle::host::truth {
namespace {

double sparc(const std::vector<double>& speeds, double step_s) {
  const double count = std::exp2(std::ceil(std::log2(static_cast<double>(speeds.size()))) + 4);
  const double frequency_Hz = 1 / (step_s * count);
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

// The jerk of the first and the last sample continues that of the next two.
double ldlj(const std::vector<double>& speeds, double step_s) {
  std::vector<double> jerks;
  for (std::size_t k = 1; k + 1 < speeds.size(); ++k) {
    jerks.push_back((speeds[k + 1] - 2 * speeds[k] + speeds[k - 1]) / (step_s * step_s));
  }
  const auto before = [](double next, double second) { return 2 * next - second; };
  const double first = before(jerks[0], jerks[1]);
  const double last = before(jerks.back(), jerks[jerks.size() - 2]);
  double sum = first * first + last * last;
  for (const double jerk : jerks) sum += jerk * jerk;
  const double peak = *std::max_element(speeds.begin(), speeds.end());
  const double duration_s = static_cast<double>(speeds.size()) * step_s;
  return -std::log(std::pow(duration_s, 3) / (peak * peak) * sum * step_s);
}

}  // namespace

TrueSmoothness smoothness(const Function& speed, const Span& span, double least_share) {
  const double peak_s = greatest_at_s(speed, span), least = least_share * speed(peak_s);
  const double begin_s = fall_s(speed, peak_s, span.begin_s, least);
  const double end_s = fall_s(speed, peak_s, span.end_s, least);
  const double parts = std::round((end_s - begin_s) / kStep_s);
  const double part_s = (end_s - begin_s) / parts;
  std::vector<double> speeds;
  for (double i = 0; i < parts; ++i) speeds.push_back(speed(begin_s + (i + 0.5) * part_s));
  return {sparc(speeds, part_s), ldlj(speeds, part_s)};
}

double greatest(const Function& value, const Span& span) {
  return value(greatest_at_s(value, span));
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
  // Between the neighbours.
  double from_s = std::max(where_s - kStep_s, span.begin_s);
  double to_s = std::min(where_s + kStep_s, span.end_s);
  for (int i = 0; i < 30; ++i) {
    const double third_s = (to_s - from_s) / 3;
    if (value(from_s + third_s) < value(to_s - third_s)) {
      from_s += third_s;
    } else {
      to_s -= third_s;
    }
  }
  return value((from_s + to_s) / 2) > most ? (from_s + to_s) / 2 : where_s;
}

double integral(const Function& value, const Span& span) {
  double sum = 0, last_s = span.begin_s, last = value(last_s);
  at_instants(span, [&](double time_s) {
    const double now = value(time_s);
    sum += (time_s - last_s) / 6 * (last + 4 * value((last_s + time_s) / 2) + now);
    last_s = time_s;
    last = now;
  });
  return sum;
}

double speed_mm_s(const PathFunction& place_mm, double time_s) {
  return velocity_mm_s(place_mm, time_s).norm();
}

// Fourth order.
Eigen::Vector3d velocity_mm_s(const PathFunction& place_mm, double time_s) {
  constexpr double h_s = 2e-4;
  return (8 * (place_mm(time_s + h_s) - place_mm(time_s - h_s)) -
          (place_mm(time_s + 2 * h_s) - place_mm(time_s - 2 * h_s))) /
         (12 * h_s);
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

double fall_s(const Function& value, double inside_s, double limit_s, double level) {
  const double step_s = limit_s < inside_s ? -kStep_s : kStep_s;
  const auto is_beyond = [&](double time_s) {
    return step_s > 0 ? time_s >= limit_s : time_s <= limit_s;
  };
  double outside_s = inside_s + step_s;
  while (!is_beyond(outside_s) && value(outside_s) >= level) {
    inside_s = outside_s;
    outside_s += step_s;
  }
  if (is_beyond(outside_s)) {
    outside_s = limit_s;
    if (value(outside_s) >= level) return limit_s;
  }
  for (int i = 0; i < 50; ++i) {
    const double middle_s = (inside_s + outside_s) / 2;
    (value(middle_s) >= level ? inside_s : outside_s) = middle_s;
  }
  return inside_s;
}

Eigen::Vector3d displacement_mm(const JawPose& pose, const Eigen::Vector3d& point_m) {
  return 1e3 * (pose.rotation * point_m + pose.translation_m - point_m);
}

// Twist about Y: 2 atan2(q_y, q_w). With q_w = sqrt(1 + trace)/2, 4 q_w q_y = R_13 - R_31.
double opening_angle_deg(const Eigen::Matrix3d& rotation) {
  return 2 * kDegrees * std::atan2(rotation(0, 2) - rotation(2, 0), 1 + rotation.trace());
}

}  // namespace condyle::host::truth
