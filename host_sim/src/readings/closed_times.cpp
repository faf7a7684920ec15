// SPDX-License-Identifier: Apache-2.0
#include "readings/closed_times.h"

#include <algorithm>
#include <cmath>

#include "statistics/quantile.h"

namespace condyle::host {

double closed_depth_m(double height_m, double noise_sd_m) {
  return std::max({0.2e-3, 5 * noise_sd_m, 0.015 * height_m});
}

double passage_s(const std::vector<double>& time_s, const std::vector<double>& z, std::size_t from,
                 int way, double level_m) {
  // Inside the closed time first: noise may have taken `from` below the level.
  std::size_t k = from;
  while (z[k] <= level_m && k > 0 && k + 1 < z.size()) k = way > 0 ? k - 1 : k + 1;
  while (true) {
    const std::size_t next = way > 0 ? k + 1 : k - 1;
    if ((way > 0 && next >= z.size()) || (way < 0 && k == 0)) return time_s[k];
    if (z[next] <= level_m && z[k] > level_m) {
      const double share = (z[k] - level_m) / (z[k] - z[next]);
      return time_s[k] + share * (time_s[next] - time_s[k]);
    }
    k = next;
  }
}

double departure_s(const std::vector<double>& time_s, const std::vector<double>& z,
                   std::size_t last, int way, double top_m, double depth_m) {
  const double t1 = passage_s(time_s, z, last, way, top_m - depth_m);
  const double t2 = passage_s(time_s, z, last, way, top_m - kDepthsOfLaw * depth_m);
  return t1 - (t2 - t1) / (std::cbrt(kDepthsOfLaw) - 1);
}

double departure_doubt_s(const std::vector<double>& time_s, const std::vector<double>& z,
                         std::size_t last, int way, double top_m, double depth_m, double height_m) {
  const double further_m = std::clamp(height_m / 8, 1.5 * depth_m, 4 * depth_m);
  return std::abs(departure_s(time_s, z, last, way, top_m, depth_m) -
                  departure_s(time_s, z, last, way, top_m, further_m));
}

double middle_of_closed_s(const std::vector<double>& time_s, const std::vector<double>& z,
                          std::size_t at, double top_m, double depth_m, bool is_slow) {
  double sum_s = 0;
  for (const int way : {-1, 1}) {
    sum_s += is_slow ? passage_s(time_s, z, at, way, top_m - depth_m)
                     : departure_s(time_s, z, at, way, top_m, depth_m);
  }
  return sum_s / 2;
}

ClosedTime ClosedTimes::around(std::size_t top, std::size_t floor, std::size_t roof,
                               double depth_m) const {
  ClosedTime closed{top, top, top, false, false};
  const double level_m = z_[top] - depth_m;
  std::vector<double> outside;
  for (std::size_t k = floor; k < top; ++k) {
    if (z_[k] > level_m) {
      closed.first = k;
      break;
    }
  }
  for (std::size_t k = top; k < roof; ++k) {
    if (z_[k] > level_m) closed.last = k;
  }
  if (closed.first == window_.begin) {
    while (!ends_at(closed.first, -1) && z_[closed.first - 1] > level_m) {
      if (z_[--closed.first] > z_[closed.top]) closed.top = closed.first;
      outside.push_back(z_[closed.first]);
    }
    closed.is_cut = ends_at(closed.first, -1);
  }
  if (closed.last + 1 == window_.end) {
    while (!ends_at(closed.last, 1) && z_[closed.last + 1] > level_m) {
      if (z_[++closed.last] > z_[closed.top]) closed.top = closed.last;
      outside.push_back(z_[closed.last]);
    }
    closed.is_cut = closed.is_cut || ends_at(closed.last, 1);
  }
  // Smoothing lets a fast movement overshoot: not by its top, but by most of it.
  closed.is_in_cycle = !outside.empty() && upper_median(std::move(outside)) > z_[top] + depth_m;
  return closed;
}

bool ClosedTimes::ends_at(std::size_t k, int way) const {
  if (way < 0) return k == 0 || time_s_[k] - time_s_[k - 1] > longest_gap_s_;
  return k + 1 == z_.size() || time_s_[k + 1] - time_s_[k] > longest_gap_s_;
}

}  // namespace condyle::host
