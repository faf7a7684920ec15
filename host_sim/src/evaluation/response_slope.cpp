// SPDX-License-Identifier: Apache-2.0
#include "evaluation/response_slope.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace condyle::host {

void ResponseSlope::add(double truth, double estimate) {
  ResponseSlope pair;
  if (std::isfinite(truth) && std::isfinite(estimate)) {
    pair.count_ = 1;
    pair.mean_x_ = truth;
    pair.mean_y_ = estimate;
  } else {
    pair.unusable_ = 1;
  }
  merge(pair);
}

void ResponseSlope::merge(const ResponseSlope& later) {
  unusable_ += later.unusable_;
  if (later.count_ == 0) return;
  const double all = static_cast<double>(count_ + later.count_);
  const double share = static_cast<double>(later.count_) / all;
  const double weight = static_cast<double>(count_) * share;
  const double dx = later.mean_x_ - mean_x_, dy = later.mean_y_ - mean_y_;
  S_xx_ += later.S_xx_ + weight * dx * dx;
  S_xy_ += later.S_xy_ + weight * dx * dy;
  S_yy_ += later.S_yy_ + weight * dy * dy;
  mean_x_ += share * dx;
  mean_y_ += share * dy;
  count_ += later.count_;
}

SlopeReport ResponseSlope::report(double confidence) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  SlopeReport report{count_, unusable_, kUnknown, kInfinity, {-kInfinity, kInfinity}, kUnknown};
  if (!(S_xx_ > 0)) return report;
  report.slope = S_xy_ / S_xx_;
  report.intercept = mean_y_ - report.slope * mean_x_;
  if (count_ < 3) return report;
  const double degrees_of_freedom = static_cast<double>(count_ - 2);
  const double residual = std::max(0.0, S_yy_ - report.slope * S_xy_);  // rounding may go below 0
  report.slope_standard_error = std::sqrt(residual / degrees_of_freedom / S_xx_);
  const double half_width =
      student_t_quantile((1 + confidence) / 2, degrees_of_freedom) * report.slope_standard_error;
  report.slope_interval = {report.slope - half_width, report.slope + half_width};
  return report;
}

}  // namespace condyle::host
