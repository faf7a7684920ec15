// SPDX-License-Identifier: Apache-2.0
// The analogue channels of a recording of points, at their own rate.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hosted/files/byte_reader.h"
#include "recordings/recording.h"

namespace condyle::host {

/// The samples of some channels, in order. Problems of the file are InputErrors.
class AnalogReader {
 public:
  virtual ~AnalogReader() = default;
  /// Next sample; false at the end.
  virtual bool next() = 0;
  /// On the clock of the positions.
  virtual TimeNs time_ns() const = 0;
  /// In the units of `channels`, in their order; NaN where the file has no number.
  virtual const std::vector<double>& values() const = 0;
  virtual const std::vector<AnalogChannel>& channels() const = 0;
  virtual std::string place() const = 0;
  virtual double progress() const = 0;
  /// On how the file was read.
  virtual const std::vector<std::string>& notes() const = 0;
};

/// The numbers of the channels `names` among `channels`. Throws an InputError that names `path` for
/// an unknown or repeated name, with the nearest one.
std::vector<std::size_t> channel_numbers(const std::vector<std::string>& names,
                                         const std::vector<AnalogChannel>& channels,
                                         const std::string& path);

/// Opens the channels `names` of the recording `path`. None if its format has no analogue channels.
/// Throws InputError for an unknown or repeated name, with the nearest one.
std::unique_ptr<AnalogReader> open_analog(const std::string& path,
                                          const std::vector<std::string>& names,
                                          FaultPolicy faults);

/// The channel `name` of the recording `path`, a force, as the drive of samples without position.
/// Throws InputError if it has no such channel, or if that is no force.
std::unique_ptr<Recording> open_analog_drive(const std::string& path, const std::string& name,
                                             FaultPolicy faults);

}  // namespace condyle::host
