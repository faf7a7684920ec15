// SPDX-License-Identifier: Apache-2.0
#include "evaluation/error_over_time.h"

#include <algorithm>
#include <cmath>

namespace condyle::host {

ErrorOverTime::ErrorOverTime(double duration_s)
    : duration_s_(duration_s), sums_(duration_s > 0 ? kStretches : 0) {}

void ErrorOverTime::add(double time_s, double error, double standard_deviation) {
  const double place = time_s / duration_s_ * static_cast<double>(kStretches);
  if (sums_.empty() || !(place >= 0) || !std::isfinite(error) ||
      !std::isfinite(standard_deviation)) {
    return;
  }
  const double last = static_cast<double>(kStretches - 1);
  Sums& sums = sums_[static_cast<std::size_t>(std::min(place, last))];
  sums.error_square += error * error;
  sums.variance += standard_deviation * standard_deviation;
  ++sums.count;
}

void ErrorOverTime::merge(const ErrorOverTime& later) {
  if (sums_.empty()) *this = ErrorOverTime(later.duration_s_);
  for (std::size_t i = 0; i < later.sums_.size(); ++i) {
    sums_[i].error_square += later.sums_[i].error_square;
    sums_[i].variance += later.sums_[i].variance;
    sums_[i].count += later.sums_[i].count;
  }
}

std::vector<ErrorOverTime::Stretch> ErrorOverTime::stretches() const {
  std::vector<Stretch> result;
  const double width_s = duration_s_ / static_cast<double>(kStretches);
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const Sums& sums = sums_[i];
    if (sums.count == 0) continue;
    const double count = static_cast<double>(sums.count);
    result.push_back({(static_cast<double>(i) + 0.5) * width_s,
                      std::sqrt(sums.error_square / count), std::sqrt(sums.variance / count)});
  }
  return result;
}

}  // namespace condyle::host
