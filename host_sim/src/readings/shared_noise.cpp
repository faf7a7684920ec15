// SPDX-License-Identifier: Apache-2.0
#include "readings/shared_noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "readings/reading.h"
#include "statistics/chi_square.h"

namespace condyle::host {
namespace {

constexpr int kRounds = 2000;   // of the fit; it changes by less than 1 % after
constexpr double kReach = 4.5;  // of a kernel, in its widths

double correlation_at(double lag, double tau) {
  return std::exp(-0.5 * (lag / tau) * (lag / tau));
}

// V(lag) of unit variance.
double response(double lag, double tau) {
  return 1 - (4 * correlation_at(lag, tau) - correlation_at(2 * lag, tau)) / 3;
}

// The same of a sixth difference, with weights whose squares sum to 1.
double response_of_sixth(double tau) {
  constexpr double kWeights[] = {1, -6, 15, -20, 15, -6, 1};
  double sum = 0, squares = 0;
  for (int i = 0; i < 7; ++i) {
    squares += kWeights[i] * kWeights[i];
    for (int j = 0; j < 7; ++j) sum += kWeights[i] * kWeights[j] * correlation_at(i - j, tau);
  }
  return sum / squares;
}

// Of two `numbers` that change slowly.
Vector6 hum_at(const SharedNoise& hum, double time_s, const Vector6& numbers) {
  const double angle = 2 * std::numbers::pi * hum.frequency_Hz * time_s;
  const double cosine = std::cos(angle), sine = std::sin(angle);
  return hum.root.col(0) * (numbers[0] * cosine - numbers[1] * sine) +
         hum.root.col(1) * (numbers[1] * cosine + numbers[0] * sine);
}

}  // namespace

double variance_over(const ReferredMotion& motion, std::size_t begin, std::size_t end,
                     std::size_t lag, int i) {
  double sum = 0;
  for (std::size_t k = begin; k + 2 * lag < end; ++k) {
    const double difference =
        motion.motion[k][i] - 2 * motion.motion[k + lag][i] + motion.motion[k + 2 * lag][i];
    sum += difference * difference;
  }
  return sum / (6 * static_cast<double>(end - begin - 2 * lag));
}

double SharedNoise::correlation(double lag_s) const {
  const double bell = correlation_at(lag_s, tau_s);
  return frequency_Hz > 0 ? bell * std::cos(2 * std::numbers::pi * frequency_Hz * lag_s) : bell;
}

NoiseParts noise_parts(const ReferredMotion& motion, std::size_t begin, std::size_t end, int i,
                       double white_least) {
  std::vector<double> taus;
  const std::size_t longest = longest_lag(end - begin);
  for (std::size_t tau = 1; 2 * tau <= longest; tau *= 2) taus.push_back(static_cast<double>(tau));
  // Rows: lags; columns: white, then the taus; all over the V(L) that is raised.
  std::vector<std::vector<double>> rows;
  double level = 0;
  for (std::size_t lag = 1; lag <= longest; lag *= 2) {
    const double independent =
        static_cast<double>(end - begin - 2 * lag) / static_cast<double>(lag);
    const double factor = student_t_quantile(0.975, independent) / kHalf95;
    const double raised = factor * factor * variance_over(motion, begin, end, lag, i);
    if (!(raised > 0)) continue;
    level = std::max(level, raised);  // a hum may be hardly seen over a whole period
    std::vector<double> row{1 / level};
    for (const double tau : taus) row.push_back(response(static_cast<double>(lag), tau) / level);
    rows.push_back(std::move(row));
  }
  // Multiplicative updates: they keep what is positive positive.
  const std::size_t unknowns = taus.size() + 1;
  std::vector<double> a(unknowns, level / static_cast<double>(unknowns)), sums(rows.size());
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      sums[r] = 0;
      for (std::size_t j = 0; j < unknowns; ++j) sums[r] += rows[r][j] * a[j];
    }
    for (std::size_t j = 0; j < unknowns; ++j) {
      double wanted = 0, is = 0;
      for (std::size_t r = 0; r < rows.size(); ++r) {
        wanted += rows[r][j];
        is += rows[r][j] * sums[r];
      }
      if (is > 0) a[j] *= wanted / is;
    }
  }
  NoiseParts parts{a[0], {a.begin() + 1, a.end()}};
  double seen = 0;
  for (std::size_t j = 0; j < taus.size(); ++j)
    seen += parts.shared[j] * response_of_sixth(taus[j]);
  parts.white = std::max(parts.white, white_least - seen);
  return parts;
}

void add_shared_noise(const std::vector<SharedNoise>& noise, const std::vector<double>& time_s,
                      RandomGenerator& random, std::vector<Vector6>& errors) {
  boost::random::normal_distribution<double> normal;
  std::vector<Vector6> numbers;
  for (const SharedNoise& part : noise) {
    // Normal numbers on a grid, under bells whose width is its step. Across a long gap samples
    // share nothing.
    const double width_s = part.tau_s / std::numbers::sqrt2;
    for (std::size_t begin = 0, end = 0; begin < time_s.size(); begin = end) {
      for (end = begin + 1; end < time_s.size(); ++end) {
        if (time_s[end] - time_s[end - 1] > 2 * kReach * width_s) break;
      }
      const double first_s = time_s[begin] - kReach * width_s;
      const double steps = (time_s[end - 1] - first_s) / width_s + kReach;
      numbers.resize(static_cast<std::size_t>(steps) + 2);
      for (Vector6& one : numbers) {
        Vector6 drawn;
        for (double& number : drawn) number = normal(random);
        one = drawn / std::sqrt(std::sqrt(std::numbers::pi));
        if (part.frequency_Hz == 0) one = part.root * one;
      }
      for (std::size_t k = begin; k < end; ++k) {
        const double place = (time_s[k] - first_s) / width_s;
        Vector6 drawn = Vector6::Zero();
        for (auto g = static_cast<std::size_t>(std::max(place - kReach, 0.0));
             g < numbers.size() && static_cast<double>(g) < place + kReach; ++g) {
          const double from = static_cast<double>(g) - place;
          drawn += std::exp(-0.5 * from * from) * numbers[g];
        }
        errors[k] += part.frequency_Hz == 0 ? drawn : hum_at(part, time_s[k], drawn);
      }
    }
  }
}

}  // namespace condyle::host
