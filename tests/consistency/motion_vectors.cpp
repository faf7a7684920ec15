// SPDX-License-Identifier: Apache-2.0
#include "consistency/motion_vectors.h"
#include "support/paths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace condyle::testing_support {
namespace {

// The second column of a file of two, and the first as time.
std::vector<double> read_columns(const std::string& path, std::vector<TimeNs>& time_ns) {
  std::ifstream file(path);
  EXPECT_TRUE(file.is_open()) << path;
  std::string header;
  std::getline(file, header);
  std::vector<double> values;
  time_ns.clear();
  double time_s = 0, value = 0;
  char comma = 0;
  while (file >> time_s >> comma >> value) {
    time_ns.push_back(nanoseconds(time_s));
    values.push_back(value);
  }
  return values;
}

// Integral of evenly sampled velocities, third-order interpolation between them.
std::vector<double> integral(const std::vector<double>& v, double T) {
  std::vector<double> p(v.size(), 0);
  for (std::size_t i = 0; i + 1 < v.size(); ++i) {
    const bool is_inside = i > 0 && i + 2 < v.size();
    const double mean =
        is_inside ? (13 * (v[i] + v[i + 1]) - v[i - 1] - v[i + 2]) / 24 : (v[i] + v[i + 1]) / 2;
    p[i + 1] = p[i] + T * mean;
  }
  return p;
}

// Written out in plain numbers, in units of the noise, apart from the estimator.
double white_jerk_error(const MotionVector& motion, double ratio, double from_s) {
  double p = motion.position_m[0], v = 0, a = 0;
  double pp = 1, pv = 0, pa = 0, vv = 1e6, va = 0, aa = 1e9;
  double square_sum = 0, count = 0;
  for (std::size_t i = 1; i < motion.size(); ++i) {
    const double T = seconds(motion.time_ns[i] - motion.time_ns[i - 1]), h = T * T / 2;
    p += T * v + h * a;
    v += T * a;
    pp += 2 * T * pv + 2 * h * pa + T * T * vv + 2 * T * h * va + h * h * aa;
    pv += T * vv + h * va + T * pa + T * (T * va + h * aa);
    pa += T * va + h * aa;
    vv += 2 * T * va + T * T * aa;
    va += T * aa;
    pp += ratio * std::pow(T, 5) / 20;
    pv += ratio * std::pow(T, 4) / 8;
    pa += ratio * std::pow(T, 3) / 6;
    vv += ratio * std::pow(T, 3) / 3;
    va += ratio * T * T / 2;
    aa += ratio * T;
    const double innovation = motion.position_m[i] - p, S = pp + 1;
    p += pp / S * innovation;
    v += pv / S * innovation;
    a += pa / S * innovation;
    vv -= pv * pv / S;
    va -= pv * pa / S;
    aa -= pa * pa / S;
    pp /= S;
    pv /= S;
    pa /= S;
    if (seconds(motion.time_ns[i]) < from_s) continue;
    square_sum += std::pow(v - motion.velocity_m_s[i], 2);
    ++count;
  }
  return std::sqrt(square_sum / count);
}

}  // namespace

MotionVector read_motion(const std::string& name, double scale) {
  const std::string path = testing_support::source_path("/tests/consistency/vectors/") + name;
  MotionVector motion;
  motion.velocity_m_s = read_columns(path + ".truth.csv", motion.time_ns);
  motion.position_m = read_columns(path + ".csv", motion.time_ns);
  EXPECT_EQ(motion.position_m.size(), motion.velocity_m_s.size());
  motion.is_measured.assign(motion.size(), true);
  if (scale == 1) return motion;
  const auto more = integral(motion.velocity_m_s, seconds(motion.time_ns[1]));
  for (std::size_t i = 0; i < motion.size(); ++i) {
    motion.position_m[i] += (scale - 1) * more[i];
    motion.velocity_m_s[i] *= scale;
  }
  return motion;
}

template <class Scalar>
std::vector<RecommendedEstimate<Scalar>> estimate_motion(
    const MotionEstimatorParameters& parameters, int lag, const MotionVector& motion) {
  RecommendedEstimator<Scalar, 1> estimator(parameters, lag);
  std::vector<RecommendedEstimate<Scalar>> estimates;
  estimates.reserve(motion.size());
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const auto estimate = estimator.step({motion.time_ns[i],
                                          motion.is_measured[i],
                                          {static_cast<Scalar>(motion.position_m[i])},
                                          {}});
    if (estimate.is_ready) estimates.push_back(estimate);
  }
  RecommendedEstimate<Scalar> estimate;
  while (estimator.drain(estimate)) estimates.push_back(estimate);
  EXPECT_EQ(estimates.size(), motion.size());
  return estimates;
}

template <class Scalar>
double velocity_error(const MotionVector& motion,
                      const std::vector<RecommendedEstimate<Scalar>>& estimates, double from_s,
                      const std::vector<bool>& counts) {
  double square_sum = 0, count = 0;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    if (seconds(motion.time_ns[i]) < from_s || (!counts.empty() && !counts[i])) continue;
    const auto velocity_m_s = static_cast<double>(estimates[i].axes[0].velocity_m_s.value);
    square_sum += std::pow(velocity_m_s - motion.velocity_m_s[i], 2);
    ++count;
  }
  return std::sqrt(square_sum / count);
}

WhiteJerkFit best_white_jerk_fit(const MotionVector& motion, double from_s) {
  WhiteJerkFit best{0, HUGE_VAL};
  const auto look = [&](double log10_ratio) {
    const double ratio = std::pow(10, log10_ratio);
    const double error_m_s = white_jerk_error(motion, ratio, from_s);
    if (error_m_s < best.error_m_s) best = {ratio, error_m_s};
  };
  for (int i = 0; i <= 14; ++i) look(5 + 0.5 * i);
  const double around = std::log10(best.ratio);
  for (int i = -4; i <= 4; ++i) look(around + 0.1 * i);
  return best;
}

template std::vector<RecommendedEstimate<double>> estimate_motion(const MotionEstimatorParameters&,
                                                                  int, const MotionVector&);
template std::vector<RecommendedEstimate<float>> estimate_motion(const MotionEstimatorParameters&,
                                                                 int, const MotionVector&);
template double velocity_error(const MotionVector&, const std::vector<RecommendedEstimate<double>>&,
                               double, const std::vector<bool>&);
template double velocity_error(const MotionVector&, const std::vector<RecommendedEstimate<float>>&,
                               double, const std::vector<bool>&);

}  // namespace condyle::testing_support
