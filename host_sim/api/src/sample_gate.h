// SPDX-License-Identifier: Apache-2.0
// Samples as a program gives them, checked as those of a file are.
#pragma once

#include <optional>

#include "condyle/estimator/sample.h"
#include "recordings/recording.h"

namespace condyle::host {

/// A sample as given.
struct GivenSample {
  std::optional<double> time_s;  ///< else time_ns
  TimeNs time_ns = 0;            ///< CONDYLE_NO_TIME: missing
  const double* position = nullptr;
  double drive_N = 0;  ///< NaN: none
};

/// Makes samples of what is given.
class SampleGate {
 public:
  SampleGate(SampleKind kind, bool has_drive, FaultPolicy faults)
      : kind_(kind), has_drive_(has_drive), faults_(faults) {}

  /// The next sample. Throws InputError, which names the sample, if faults are refused and its time
  /// is missing or runs backwards, or a number is infinite; it is then as if it had not been given.
  Sample next(const GivenSample& given);

 private:
  [[noreturn]] void refuse(const char* field, const std::string& problem) const;
  bool refuses() const { return faults_ == FaultPolicy::refuse; }
  void take_time(const GivenSample& given, Sample& sample) const;
  void take_position(const double* position, Sample& sample) const;
  void take_drive(double drive_N, Sample& sample) const;

  SampleKind kind_;
  bool has_drive_;
  FaultPolicy faults_;
  std::uint64_t count_ = 0;  // of samples so far
  std::optional<TimeNs> last_ns_;
};

}  // namespace condyle::host
