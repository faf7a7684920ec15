// SPDX-License-Identifier: Apache-2.0
#include "readings/pose_noise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "readings/hum.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

constexpr std::size_t kOrder = 6;
constexpr double kSquaresOfSixth = 924;                         // of the binomial numbers
constexpr double kLongestOfSteps = 3, kShortestOfSteps = 0.02;  // over the mean
constexpr std::ptrdiff_t kFastOf = 5, kLeastFast = 40;          // the fastest fifth, if so many
// Of the squared median of n differences of noise, times sqrt(n), the relative standard deviation,
// by simulation. Seven neighbours share samples.
constexpr double kOfMedian = 3.3;
constexpr double kMedianOfSize = 0.67448975;  // of a standard normal number
// Below any recording's digits (m, rad): without noise, rounding must not decide.
constexpr double kRounding = 1e-11;
constexpr double kLongestStep_s = 0.06;  // as long as the windows of LocalFit
constexpr std::size_t kMostDifferences = 200'000;

// A sixth divided difference, and the rates of the motion there (per s).
struct Difference {
  Vector6 value, rate;
};

// Whether seven samples from `k` are near enough to each other.
bool is_close(const std::vector<double>& time_s, std::size_t k) {
  const double step_s = (time_s[k + kOrder] - time_s[k]) / kOrder;
  for (std::size_t i = 0; i < kOrder; ++i) {
    const double here_s = time_s[k + i + 1] - time_s[k + i];
    if (here_s > kLongestOfSteps * step_s || here_s < kShortestOfSteps * step_s) return false;
  }
  return step_s < 0.1;
}

std::vector<Difference> sixth_differences(const ReferredMotion& motion) {
  std::vector<Difference> differences;
  const auto& time_s = motion.time_s;
  const std::size_t count = time_s.size(), stride = 1 + count / kMostDifferences;
  for (std::size_t k = 0; k + kOrder < count; k += stride) {
    if (!is_close(time_s, k)) continue;
    const double span_s = time_s[k + kOrder] - time_s[k];
    Difference difference{Vector6::Zero(), (motion.motion[k + kOrder] - motion.motion[k]) / span_s};
    double squares = 0;
    for (std::size_t i = 0; i <= kOrder; ++i) {
      double weight = 1;
      for (std::size_t j = 0; j <= kOrder; ++j) {
        if (j != i) weight *= span_s / (time_s[k + i] - time_s[k + j]);
      }
      squares += weight * weight;
      difference.value += weight * motion.motion[k + i];
    }
    difference.value /= std::sqrt(squares);
    differences.push_back(difference);
  }
  return differences;
}

// Standard deviation of component `i` of the differences from `begin` to `end`, from the median of
// its size.
double sd_of(std::vector<Difference>::const_iterator begin,
             std::vector<Difference>::const_iterator end, int i) {
  std::vector<double> sizes;
  sizes.reserve(static_cast<std::size_t>(end - begin));
  for (auto at = begin; at != end; ++at) sizes.push_back(std::abs(at->value[i]));
  return upper_median(std::move(sizes)) / kMedianOfSize;
}

// Standard deviation of the times (s), and of the noise without them; `sd` stays where the times
// are right.
double stamp_sd_s(std::vector<Difference> differences, const Matrix6& least, Vector6& sd) {
  const auto count = static_cast<std::ptrdiff_t>(differences.size());
  const std::ptrdiff_t fast_count = count / kFastOf;
  if (fast_count < kLeastFast) return 0;
  // Four standard deviations of the logarithm of the ratio below, whose distribution is skewed.
  const double chance =
      4 * kOfMedian *
      std::sqrt(1 / static_cast<double>(fast_count) + 2 / static_cast<double>(count));
  double greatest_ratio = 1, stamp_s2 = 0;
  Vector6 slow_sd = sd;
  for (int i = 0; i < 6; ++i) {
    const auto is_slower = [i](const Difference& a, const Difference& b) {
      return std::abs(a.rate[i]) < std::abs(b.rate[i]);
    };
    const auto middle = differences.begin() + count / 2, fast = differences.end() - fast_count;
    std::nth_element(differences.begin(), middle, differences.end(), is_slower);
    std::nth_element(middle, fast, differences.end(), is_slower);
    slow_sd[i] = std::max(sd_of(differences.begin(), middle, i), std::sqrt(least(i, i)));
    const double fast_sd = sd_of(fast, differences.end(), i);
    double squares = 0;
    for (auto at = fast; at != differences.end(); ++at) squares += at->rate[i] * at->rate[i];
    const double slow2 = slow_sd[i] * slow_sd[i] + kRounding * kRounding;
    const double fast2 = fast_sd * fast_sd;
    // The component where the times matter most.
    if (!(fast2 > slow2 * std::max(std::exp(chance), greatest_ratio)) || !(squares > 0)) continue;
    greatest_ratio = fast2 / slow2;
    stamp_s2 = (fast2 - slow2) / (squares / static_cast<double>(fast_count));
  }
  if (stamp_s2 > 0) sd = slow_sd;
  return std::sqrt(stamp_s2);
}

// Ratio of the variance that second differences over `step` samples show to that of `differences`
// sixth differences, less what chance explains; of the component where it is largest.
double ratio_over(const ReferredMotion& motion, std::size_t begin, std::size_t end,
                  std::size_t step, const Matrix6& covariance, double differences) {
  double largest = 1;
  const double count = static_cast<double>(end - begin) - 2 * static_cast<double>(step);
  for (int i = 0; i < 6; ++i) {
    if (!(covariance(i, i) > 0)) continue;
    const double ratio = variance_over(motion, begin, end, step, i) / covariance(i, i);
    // Neighbouring differences share samples: about half of them are independent.
    const double sd = std::sqrt(4 / count + kOfMedian * kOfMedian / differences);
    largest = std::max(largest, ratio / (1 + 3 * sd));
  }
  return largest;
}

// A root that changes little if the covariance does, so that readings do not depend on rounding;
// absent where the covariance is none.
std::optional<Matrix6> root_of(const Matrix6& covariance) {
  const Matrix6 raised = covariance + Matrix6(covariance.diagonal().asDiagonal()) * 1e-9;
  const Eigen::LLT<Matrix6> factor(raised);
  if (factor.info() != Eigen::Success) return std::nullopt;
  return Matrix6(factor.matrixL());
}

// Variance that sixth differences of a hum of unit variance have, with weights as in the latter.
double response_of_sixth(const Hum& hum, double step_s) {
  const double half_angle = std::numbers::pi * hum.frequency_Hz * step_s;
  return std::pow(2 * std::sin(half_angle), 2 * kOrder) / kSquaresOfSixth;
}

// What neighbours share at the rest, with the correlations between components that `noise` has.
void share(const ReferredMotion& motion, SampleRun run, Vector6 white_sd,
           const std::vector<Hum>& hums, PoseNoise& noise) {
  const double rest_s = motion.time_s[run.end - 1] - motion.time_s[run.begin];
  const double step_s = rest_s / static_cast<double>(run.end - run.begin - 1);
  const ReferredMotion rest = without(hums, motion, run.begin, run.end);
  for (const Hum& hum : hums) {
    white_sd = (white_sd.cwiseAbs2() - response_of_sixth(hum, step_s) * hum.variances())
                   .cwiseMax(0)
                   .cwiseSqrt();
  }
  const Vector6 inverse =
      noise.covariance.diagonal().cwiseSqrt().cwiseMax(kRounding).cwiseInverse();
  const Matrix6 correlation_root = inverse.asDiagonal() * noise.root;
  Vector6 white;
  std::vector<Vector6> shared;
  for (int i = 0; i < 6; ++i) {
    const NoiseParts parts = noise_parts(rest, 0, rest.time_s.size(), i, white_sd[i] * white_sd[i]);
    white[i] = parts.white;
    shared.resize(parts.shared.size());
    for (std::size_t j = 0; j < shared.size(); ++j) shared[j][i] = parts.shared[j];
  }
  const auto of = [&](const Vector6& variances) {
    return Matrix6(variances.cwiseSqrt().asDiagonal() * correlation_root);
  };
  noise.beside_shared = of(white);
  double tau = 1;
  for (const Vector6& variances : shared) {
    noise.shared.push_back({tau * step_s, of(variances)});
    tau *= 2;
  }
  for (const Hum& hum : hums) {
    SharedNoise part{rest_s, Matrix6::Zero(), hum.frequency_Hz};
    part.root.col(0) = hum.cosine / std::numbers::sqrt2;
    part.root.col(1) = hum.sine / std::numbers::sqrt2;
    noise.shared.push_back(part);
  }
}

}  // namespace

PoseNoise noise_of(const ReferredMotion& motion, std::size_t begin, std::size_t end,
                   const Matrix6& least) {
  PoseNoise noise;
  const std::vector<Difference> differences = sixth_differences(motion);
  if (differences.size() < 7) return noise;
  noise.is_known = true;
  Vector6 sd;
  for (int i = 0; i < 6; ++i) sd[i] = sd_of(differences.begin(), differences.end(), i);
  noise.stamp_sd_s = stamp_sd_s(differences, least, sd);
  sd = sd.cwiseMax(least.diagonal().cwiseSqrt());
  const double count = static_cast<double>(differences.size());
  for (int i = 0; i < 6; ++i) {
    noise.covariance(i, i) = sd[i] * sd[i];
    for (int j = 0; j < i; ++j) {
      double equal = 0;
      for (const Difference& d : differences) {
        const double product = d.value[i] * d.value[j];
        equal += product > 0 ? 1 : product < 0 ? -1 : 0;
      }
      const double correlation = std::sin(std::numbers::pi / 2 * equal / count);
      // Below what chance gives, no correlation.
      if (std::abs(equal) < 6 * std::sqrt(count)) continue;
      noise.covariance(i, j) = noise.covariance(j, i) = correlation * sd[i] * sd[j];
    }
  }
  const double step_s = (motion.time_s.back() - motion.time_s.front()) /
                        static_cast<double>(motion.time_s.size() - 1);
  const auto longest = static_cast<std::size_t>(std::max(2.0, kLongestStep_s / step_s));
  noise.is_checked_at_rest = end - begin >= 6 * longest;
  bool is_shared = false;
  const SampleRun middle = middle_of_rest({begin, end});
  std::vector<Hum> hums;
  if (noise.is_checked_at_rest) {
    for (std::size_t step = 1; step <= longest; step *= 2) {
      noise.coloured =
          std::max(noise.coloured, ratio_over(motion, begin, end, step, noise.covariance, count));
    }
    is_shared = noise.coloured > 1;
    hums = hums_of(motion, middle.begin, middle.end);
    is_shared = is_shared || !hums.empty();
    for (std::size_t step = 1; step <= longest_lag(end - begin); step *= 2) {
      is_shared = is_shared || ratio_over(motion, begin, end, step, noise.covariance, count) > 1;
    }
  }
  noise.covariance *= noise.coloured;
  if (const auto root = root_of(noise.covariance)) {
    noise.root = *root;
  } else {
    const Vector6 variances = noise.covariance.diagonal();
    noise.root = variances.cwiseSqrt().asDiagonal();
    noise.covariance = variances.asDiagonal();
  }
  if (is_shared) share(motion, hums.empty() ? SampleRun{begin, end} : middle, sd, hums, noise);
  // What changes sign in a mirror at Y = 0 is drawn from the side to which the jaw moves, so that a
  // mirrored recording draws mirrored noise.
  double aside = 0;
  for (const Vector6& place : motion.motion) aside += place[1];
  if (aside < 0) {
    mirror_columns(noise.root);
    mirror_columns(noise.beside_shared);
    for (SharedNoise& part : noise.shared) {
      if (part.frequency_Hz == 0) mirror_columns(part.root);
    }
  }
  return noise;
}

void grow(PoseNoise& noise, double factor) {
  noise.covariance *= factor;
  noise.root *= std::sqrt(factor);
  noise.beside_shared *= std::sqrt(factor);
  for (SharedNoise& part : noise.shared) part.root *= std::sqrt(factor);
}

Matrix6 covariance_of_mean(const PoseNoise& noise, std::size_t count, double step_s) {
  const double samples = static_cast<double>(count);
  if (noise.shared.empty()) return noise.covariance / samples;
  Matrix6 covariance = noise.beside_shared * noise.beside_shared.transpose() / samples;
  for (const SharedNoise& part : noise.shared) {
    // The integral of its correlation, over the time of the mean.
    const double mean_s = samples * step_s;
    const double together = part.frequency_Hz > 0
                                ? std::pow(std::numbers::pi * part.frequency_Hz * mean_s, -2)
                                : std::sqrt(2 * std::numbers::pi) * part.tau_s / mean_s;
    covariance += std::min(1.0, together) * part.root * part.root.transpose();
  }
  return covariance;
}

void mirror_columns(Matrix6& root) {
  for (const int i : {1, 3, 5}) root.col(i) *= -1;
}

}  // namespace condyle::host
