// SPDX-License-Identifier: Apache-2.0
#include "readings/hum.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>

#include "statistics/quantile.h"

namespace condyle::host {
namespace {

constexpr std::size_t kMostHums = 4;
constexpr std::size_t kMostSamples = 2048;  // over more, a frequency is not known well enough
constexpr double kLine = 100;               // over the median of the neighbours
constexpr std::size_t kLeastPeriods = 8, kNearest = 2, kFarthest = 12, kLeastNeighbours = 10;
constexpr double kLeastShare = 1e-3;  // of the variance; what the fit of a hum leaves is less
constexpr int kTurns = 30;            // of the search for f; each leaves 0.62 of the interval
constexpr double kGolden = 0.61803398874989485;
// Below any recording's digits (m^2, rad^2).
constexpr double kRounding = 1e-22;

double angle_of(double frequency_Hz, double time_s) {
  return 2 * std::numbers::pi * frequency_Hz * time_s;
}

double duration_s(const ReferredMotion& rest) {
  const double intervals = static_cast<double>(rest.time_s.size()) - 1;
  return (rest.time_s.back() - rest.time_s.front()) * (1 + 1 / intervals);
}

// Powers of one component at multiples of 1/T; that of frequency 0 is left 0.
std::vector<double> powers_of(const ReferredMotion& rest, int component) {
  const std::size_t count = rest.time_s.size();
  double mean = 0;
  for (const Vector6& place : rest.motion) mean += place[component];
  mean /= static_cast<double>(count);
  std::vector<std::complex<double>> sums(count / 2, 0);
  for (std::size_t k = 0; k < count; ++k) {
    const double share = (rest.time_s[k] - rest.time_s.front()) / duration_s(rest);
    const std::complex<double> turn = std::polar(1.0, -2 * std::numbers::pi * share);
    std::complex<double> number =
        (1 - turn.real()) * (rest.motion[k][component] - mean);  // with Hann's window
    for (std::size_t bin = 1; bin < sums.size(); ++bin) sums[bin] += number *= turn;
  }
  std::vector<double> powers;
  for (const auto& sum : sums) powers.push_back(std::norm(sum));
  return powers;
}

// P over the median of its neighbours; 0 if there are too few.
double height_of_line(const std::vector<double>& powers, std::size_t bin) {
  std::vector<double> neighbours;
  for (std::size_t away = kNearest + 1; away <= kFarthest; ++away) {
    if (bin > away) neighbours.push_back(powers[bin - away]);
    if (bin + away < powers.size()) neighbours.push_back(powers[bin + away]);
  }
  if (neighbours.size() < kLeastNeighbours) return 0;
  return powers[bin] / (upper_median(std::move(neighbours)) + kRounding);
}

// The bin of the strongest line.
std::optional<std::size_t> line_of(const ReferredMotion& rest) {
  std::optional<std::size_t> line;
  double highest = kLine;
  for (int component = 0; component < 6; ++component) {
    const std::vector<double> powers = powers_of(rest, component);
    for (std::size_t bin = kLeastPeriods; bin < powers.size(); ++bin) {
      const double height = height_of_line(powers, bin);
      if (height <= highest) continue;
      highest = height;
      line = bin;
    }
  }
  return line;
}

struct Fit {
  Hum hum;
  double misfit = 0;  // sum of the components' squares over their variances
};

Fit fit_at(const ReferredMotion& rest, const Vector6& variances, double frequency_Hz) {
  const auto count = static_cast<Eigen::Index>(rest.time_s.size());
  Eigen::MatrixXd laws(count, 6), values(count, 6);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double time_s = rest.time_s[static_cast<std::size_t>(k)];
    const double angle = angle_of(frequency_Hz, time_s);
    const double share = (time_s - rest.time_s.front()) / duration_s(rest) - 0.5;
    laws.row(k) << std::cos(angle), std::sin(angle), 1, share, share * share, share * share * share;
    values.row(k) = rest.motion[static_cast<std::size_t>(k)].transpose();
  }
  const Eigen::MatrixXd found = laws.householderQr().solve(values);
  Fit fit{{frequency_Hz, found.row(0).transpose(), found.row(1).transpose()}, 0};
  const Vector6 squares = (values - laws * found).colwise().squaredNorm().transpose();
  for (int i = 0; i < 6; ++i) fit.misfit += squares[i] / (variances[i] + kRounding);
  return fit;
}

Vector6 variances_of(const ReferredMotion& rest) {
  Vector6 sum = Vector6::Zero(), squares = Vector6::Zero();
  for (const Vector6& place : rest.motion) sum += place;
  const double count = static_cast<double>(rest.motion.size());
  for (const Vector6& place : rest.motion) squares += (place - sum / count).cwiseAbs2();
  return squares / count;
}

// By golden sections around the line.
Hum fit_near(const ReferredMotion& rest, std::size_t bin) {
  const Vector6 variances = variances_of(rest);
  const double bin_Hz = 1 / duration_s(rest);
  double low = (static_cast<double>(bin) - 1) * bin_Hz, high = low + 2 * bin_Hz;
  Fit left = fit_at(rest, variances, high - kGolden * (high - low));
  Fit right = fit_at(rest, variances, low + kGolden * (high - low));
  for (int turn = 0; turn < kTurns; ++turn) {
    if (left.misfit < right.misfit) {
      high = right.hum.frequency_Hz;
      right = left;
      left = fit_at(rest, variances, high - kGolden * (high - low));
    } else {
      low = left.hum.frequency_Hz;
      left = right;
      right = fit_at(rest, variances, low + kGolden * (high - low));
    }
  }
  return left.misfit < right.misfit ? left.hum : right.hum;
}

}  // namespace

ReferredMotion without(const std::vector<Hum>& hums, const ReferredMotion& motion,
                       std::size_t begin, std::size_t end) {
  ReferredMotion rest{motion.middle_m, {}, {}};
  for (std::size_t k = begin; k < end; ++k) {
    rest.time_s.push_back(motion.time_s[k]);
    Vector6 place = motion.motion[k];
    for (const Hum& hum : hums) {
      const double angle = angle_of(hum.frequency_Hz, motion.time_s[k]);
      place -= std::cos(angle) * hum.cosine + std::sin(angle) * hum.sine;
    }
    rest.motion.push_back(place);
  }
  return rest;
}

SampleRun middle_of_rest(SampleRun rest) {
  const std::size_t count = rest.end - rest.begin;
  if (count <= kMostSamples) return rest;
  const std::size_t begin = rest.begin + (count - kMostSamples) / 2;
  return {begin, begin + kMostSamples};
}

std::vector<Hum> hums_of(const ReferredMotion& motion, std::size_t begin, std::size_t end) {
  const Vector6 least = kLeastShare * variances_of(without({}, motion, begin, end));
  std::vector<Hum> hums;
  while (hums.size() < kMostHums && end - begin > 2 * kLeastPeriods) {
    const ReferredMotion rest = without(hums, motion, begin, end);
    const auto line = line_of(rest);
    if (!line) break;
    const Hum hum = fit_near(rest, *line);
    if ((hum.variances().array() < least.array()).all()) break;
    hums.push_back(hum);
  }
  return hums;
}

}  // namespace condyle::host
