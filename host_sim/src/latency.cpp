// SPDX-License-Identifier: Apache-2.0
#include "latency.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace condyle::host {
namespace {

constexpr double kFirst_ns = 100, kStep = 1.05;

}  // namespace

void Latency::add(TimeNs latency_ns) {
  const double steps =
      std::log(std::max(static_cast<double>(latency_ns), kFirst_ns) / kFirst_ns) / std::log(kStep);
  ++bins_[std::min(static_cast<std::size_t>(steps), kBins - 1)];
  ++count_;
  largest_ns_ = std::max(largest_ns_, latency_ns);
}

double Latency::quantile_ns(double quantile) const {
  const double wanted = quantile * static_cast<double>(count_);
  double seen = 0;
  for (std::size_t i = 0; i < kBins; ++i) {
    seen += static_cast<double>(bins_[i]);
    if (seen >= wanted && seen > 0) {
      return std::min(kFirst_ns * std::pow(kStep, static_cast<double>(i + 1)),
                      static_cast<double>(largest_ns_));
    }
  }
  return 0;
}

std::string Latency::words() const {
  if (count_ == 0) return "no samples";
  return fmt::format("p50 {:.3g} us, p99 {:.3g} us, at most {:.3g} us from arrival to estimate",
                     quantile_ns(0.5) * 1e-3, quantile_ns(0.99) * 1e-3,
                     static_cast<double>(largest_ns_) * 1e-3);
}

}  // namespace condyle::host
