// SPDX-License-Identifier: Apache-2.0
// A recording from the bytes of its file: what is read, or the message that refuses it.
#pragma once

#include <string>
#include <vector>

#include "hosted/files/input_error.h"
#include "recordings/named_points.h"
#include "support/temporary_folder.h"

namespace condyle::testing_support {

/// "no error" if `read` throws none.
template <class Reader>
std::string message_of(Reader&& read) {
  try {
    static_cast<void>(read());
  } catch (const host::InputError& error) {
    return error.what();
  }
  return "no error";
}

/// Its samples, of one point or three.
namespace samples {

struct Read {
  host::RecordingInfo info;
  std::vector<Sample> samples;
};

inline Read read(const std::string& content, const host::RecordingOptions& options = {}) {
  const TemporaryFolder folder;
  const auto recording = host::open_recording(folder.write("recording", content), options);
  Read result;
  Sample sample;
  while (recording->next(sample)) result.samples.push_back(sample);
  result.info = recording->info();
  return result;
}

inline std::string problem_of(const std::string& content,
                              const host::RecordingOptions& options = {}) {
  return message_of([&] { return read(content, options); });
}

}  // namespace samples

/// Its points by name, of any number. `name`: of the file.
namespace places {

struct Read {
  host::RecordingInfo info;
  std::vector<std::string> names;
  std::vector<double> times_s;
  std::vector<Eigen::Matrix3Xd> points_m;
};

inline Read read(const std::string& content, const host::RecordingOptions& options = {},
                 const std::string& name = "recording") {
  const TemporaryFolder folder;
  const auto recording = host::open_to_describe(folder.write(name, content), options);
  auto* const named = dynamic_cast<host::NamedPointsRecording*>(recording.get());
  Read result;
  if (named == nullptr) throw host::InputError("the points have no names");
  result.names = named->names();
  Sample sample;
  while (recording->next(sample)) {
    result.times_s.push_back(seconds(sample.time_ns));
    result.points_m.push_back(named->points_m());
  }
  result.info = recording->info();
  return result;
}

inline std::string problem_of(const std::string& content,
                              const host::RecordingOptions& options = {},
                              const std::string& name = "recording") {
  return message_of([&] { return read(content, options, name); });
}

}  // namespace places

}  // namespace condyle::testing_support
