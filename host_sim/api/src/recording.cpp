// SPDX-License-Identifier: Apache-2.0
// Recordings as arrays.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "call.h"
#include "condyle/hal/clock.h"
#include "options/analysis_options.h"
#include "recordings/replay_facebow.h"

using namespace condyle;
using namespace condyle::host;

struct condyle_recording {
  RecordingInfo info;
  double step_s = 0;
  std::vector<std::int64_t> time_ns;
  std::vector<double> position, drive_N;
};

namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

void add(const Sample& sample, condyle_recording& recording) {
  const std::size_t count = coordinate_count(recording.info.kind);
  const double* const coordinates = sample.coordinates;
  recording.time_ns.push_back(sample.time_valid ? sample.time_ns : CONDYLE_NO_TIME);
  // A position that the device itself marks as not valid may look like any other.
  const bool looks_valid = !is_out_of_range(sample.kind, coordinates) &&
                           std::all_of(coordinates, coordinates + count,
                                       [](double value) { return std::isfinite(value); });
  for (std::size_t i = 0; i < count; ++i) {
    recording.position.push_back(looks_valid && !sample.position_valid ? kMissing : coordinates[i]);
  }
  if (recording.info.has_drive) {
    recording.drive_N.push_back(sample.drive_valid ? sample.drive_N : kMissing);
  }
}

std::unique_ptr<condyle_recording> read_recording(const std::string& source,
                                                  const RecordingOptions& options) {
  hal::SteadyClock clock;
  ReplayFacebow facebow(source, options, 0, clock);
  if (facebow.open() != hal::Status::ok) throw InputError(facebow.problem());
  auto recording = std::make_unique<condyle_recording>();
  recording->info = facebow.info();
  recording->step_s = seconds(facebow.expected_step_ns());
  for (;;) {
    Sample sample;
    const hal::Status status = facebow.read(0, sample);
    if (!facebow.problem().empty()) throw InputError(facebow.problem());
    if (status == hal::Status::ok) {
      add(sample, *recording);
    } else if (status == hal::Status::disconnected) {
      static_cast<void>(facebow.open());  // continues behind it
    } else if (status != hal::Status::bad_report) {
      break;
    }
  }
  // Notes may come while it is read.
  recording->info = facebow.info();
  return recording;
}

}  // namespace

condyle_status condyle_recording_read(const char* source, const char* const* options,
                                      size_t option_count, condyle_recording** recording) {
  return guarded(__func__, [&] {
    demand(recording != nullptr, "recording is NULL; give the address of a pointer");
    *recording = nullptr;
    const std::string path = given_text(source, "source");
    RecordingOptions reading;
    parse_options("condyle_recording_read", options, option_count, [&](CommandLine line) {
      add_faults_option(line, reading);
      add_reading_options(line, reading);
    });
    *recording = read_recording(path, reading).release();
    return CONDYLE_OK;
  });
}

void condyle_recording_free(condyle_recording* recording) {
  delete recording;
}

int condyle_recording_kind(const condyle_recording* recording) {
  return recording != nullptr ? static_cast<int>(recording->info.kind) : -1;
}

size_t condyle_recording_count(const condyle_recording* recording) {
  return recording != nullptr ? recording->time_ns.size() : 0;
}

const int64_t* condyle_recording_time_ns(const condyle_recording* recording) {
  return recording != nullptr ? recording->time_ns.data() : nullptr;
}

const double* condyle_recording_position(const condyle_recording* recording) {
  return recording != nullptr ? recording->position.data() : nullptr;
}

const double* condyle_recording_drive_N(const condyle_recording* recording) {
  return recording != nullptr && recording->info.has_drive ? recording->drive_N.data() : nullptr;
}

double condyle_recording_step_s(const condyle_recording* recording) {
  return recording != nullptr ? recording->step_s : 0;
}

const char* condyle_recording_format(const condyle_recording* recording) {
  return recording != nullptr ? recording->info.format.c_str() : "";
}

size_t condyle_recording_note_count(const condyle_recording* recording) {
  return recording != nullptr ? recording->info.notes.size() : 0;
}

const char* condyle_recording_note(const condyle_recording* recording, size_t index) {
  return index < condyle_recording_note_count(recording) ? recording->info.notes[index].c_str()
                                                         : "";
}

const char* condyle_recording_parameters(const condyle_recording* recording) {
  return recording != nullptr ? recording->info.parameters_toml.c_str() : "";
}
