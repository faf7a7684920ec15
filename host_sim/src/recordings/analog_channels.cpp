// SPDX-License-Identifier: Apache-2.0
#include "recordings/analog_channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hosted/files/input_error.h"
#include "hosted/files/nearest_word.h"
#include "recordings/c3d.h"
#include "recordings/file_units.h"
#include "recordings/point_list.h"

namespace condyle::host {
namespace {

class AnalogDrive final : public Recording {
 public:
  AnalogDrive(std::unique_ptr<AnalogReader> reader, const std::string& path)
      : reader_(std::move(reader)) {
    const AnalogChannel& channel = reader_->channels()[0];
    const auto newtons = newtons_in(channel.unit);
    if (!newtons) {
      throw InputError(
          path,
          channel.unit.empty()
              ? fmt::format("states no unit of the channel {}", channel.name)
              : fmt::format("states the channel {} in {}, which is not a unit of force",
                            channel.name, channel.unit),
          "give the drive as CSV with time_s and drive_N");
    }
    newtons_ = *newtons;
    info_.format = fmt::format("analogue channel {} at {:g} Hz", channel.name, channel.rate_Hz);
    info_.has_drive = true;
    info_.nominal_step_ns = nanoseconds(1 / channel.rate_Hz);
    info_.notes = reader_->notes();
  }

  bool next(Sample& sample) override {
    if (!reader_->next()) {
      info_.notes = reader_->notes();
      return false;
    }
    sample = Sample{};
    sample.sequence = sequence_++;
    sample.time_ns = reader_->time_ns();
    sample.position_valid = false;
    sample.drive_N = newtons_ * reader_->values()[0];
    sample.drive_valid = std::isfinite(sample.drive_N);
    return true;
  }

  const RecordingInfo& info() const override { return info_; }
  std::string place() const override { return reader_->place(); }
  double progress() const override { return reader_->progress(); }

 private:
  std::unique_ptr<AnalogReader> reader_;
  double newtons_ = 1;  // in the channel's unit
  RecordingInfo info_;
  std::uint64_t sequence_ = 0;
};

}  // namespace

std::vector<std::size_t> channel_numbers(const std::vector<std::string>& names,
                                         const std::vector<AnalogChannel>& channels,
                                         const std::string& path) {
  std::vector<std::string> all;
  for (const AnalogChannel& channel : channels) all.push_back(channel.name);
  std::vector<std::size_t> numbers;
  for (const std::string& name : names) {
    const auto found = std::find(all.begin(), all.end(), name);
    if (found == all.end()) {
      const std::string nearest = nearest_word(name, all);
      throw InputError(path, fmt::format("has no analogue channel {}", name),
                       all.empty()        ? "condyle info shows what it holds"
                       : !nearest.empty() ? fmt::format("did you mean {}?", nearest)
                                          : "its channels are " + list_of_points(all));
    }
    if (std::find(found + 1, all.end(), name) != all.end()) {
      throw InputError(path, fmt::format("has several analogue channels {}", name),
                       "give them different names, and export the recording again");
    }
    numbers.push_back(static_cast<std::size_t>(found - all.begin()));
  }
  return numbers;
}

std::unique_ptr<AnalogReader> open_analog(const std::string& path,
                                          const std::vector<std::string>& names,
                                          FaultPolicy faults) {
  auto reader = std::make_unique<ByteReader>(path);
  if (!looks_like_c3d(*reader)) return nullptr;
  return open_c3d_analog(std::move(reader), names, faults);
}

std::unique_ptr<Recording> open_analog_drive(const std::string& path, const std::string& name,
                                             FaultPolicy faults) {
  auto reader = open_analog(path, {name}, faults);
  if (!reader) {
    throw InputError(path, "has no analogue channels",
                     "give the drive as CSV with time_s and drive_N, or as a session log");
  }
  return std::make_unique<AnalogDrive>(std::move(reader), path);
}

}  // namespace condyle::host
