// SPDX-License-Identifier: Apache-2.0
// Estimates and markers as two streams of the Lab Streaming Layer: NAME, and NAME-markers.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/estimator/impedance/impedance_estimate.h"
#include "condyle/estimator/motion/recommended_estimate.h"
#include "condyle/estimator/sensors/driven_sensor.h"
#include "hosted/lsl/outlet.h"

namespace condyle::host::lsl {

/// What the estimates of a stream hold.
struct EstimateStreamSettings {
  std::string place;           ///< NAME, or NAME@ADDRESS with an IPv4 address of this computer
  int axis_count = 3;          ///< or 1
  bool has_impedance = false;  ///< friction and mass are identified
  double rate_Hz = 0;          ///< nominal; 0: irregular
};

/// Each estimate is a sample of doubles: for each axis the measured position, then position,
/// velocity, acceleration and force, each with its standard deviation and provenance; then friction
/// and mass in the same way. A withheld value is NaN. The stamp is the instant of the estimate on
/// this machine's monotonic clock, which is LSL's. No call waits for a reader.
class EstimateStream {
 public:
  /// Throws an InputError if the streams cannot be offered.
  EstimateStream(const EstimateStreamSettings& settings, hal::Clock& clock);

  void add(const RecommendedEstimate<double>& estimate);
  void add(const DrivenEstimate<double>& estimate);
  /// A marker, at the present time.
  void mark(std::string_view text);
  /// Gives readers a second to take the rest, and ends the streams.
  void finish() { outlet_.finish(kNanosecondsPerSecond); }

  /// "NAME at 127.0.0.1: 600 estimates, 2 readers, ..."
  std::string summary() const;
  OutletCounts counts() const { return outlet_.counts(); }
  const std::vector<StreamChannel>& channels() const { return info_.channels; }

 private:
  void add_motion(const RecommendedEstimate<double>& estimate);
  void push(const RecommendedEstimate<double>& estimate);

  EstimateStreamSettings settings_;
  hal::Clock& clock_;
  StreamInfo info_;
  std::vector<double> values_;
  std::atomic<std::uint64_t> estimates_ = 0, markers_ = 0, untimed_ = 0;
  Outlet outlet_;
};

/// The name and the address of this computer in NAME or NAME@ADDRESS; throws an InputError if they
/// are not usable.
void check_outlet_place(const std::string& place);

}  // namespace condyle::host::lsl
