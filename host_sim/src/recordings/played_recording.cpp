// SPDX-License-Identifier: Apache-2.0
#include "recordings/played_recording.h"

#include <fmt/format.h>

#include <chrono>
#include <cstring>
#include <limits>
#include <thread>
#include <vector>

#include "condyle/hal/log/session_log.h"
#include "condyle/hal/log/session_log_reader.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "recordings/recording.h"
#include "recordings/recording_files.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

constexpr std::size_t kRingReports = 16'384;
constexpr std::size_t kJudgedSteps = 1000;
constexpr std::size_t kBytes = sizeof(double);

RecordingOptions with_events() {
  RecordingOptions options;
  options.faults = FaultPolicy::event;
  return options;
}

// Text between the quotes of TOML.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : clean_line(text)) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + "\"";
}

// The median of the first steps; 0 if there is none.
double usual_step_s(const std::string& source) {
  const auto recording = open_recording(source, with_events());
  if (recording->info().nominal_step_ns) return seconds(*recording->info().nominal_step_ns);
  std::vector<double> steps_s;
  Sample sample;
  bool has_last = false;
  TimeNs last_ns = 0;
  while (steps_s.size() < kJudgedSteps && recording->next(sample)) {
    if (!sample.time_valid) continue;
    if (has_last && sample.time_ns > last_ns) {
      steps_s.push_back(difference_s<double>(sample.time_ns, last_ns));
    }
    last_ns = sample.time_ns;
    has_last = true;
  }
  if (steps_s.empty()) return 0;
  return upper_median(std::move(steps_s));
}

const char* name_of(SampleKind kind) {
  switch (kind) {
    case SampleKind::one_axis:
      return "one_axis";
    case SampleKind::one_point:
      return "one_point";
    case SampleKind::three_points:
      return "three_points";
    case SampleKind::pose:
      return "pose";
  }
  return "";
}

// A report holds the coordinates as doubles, then the drive.
std::string profile_of(const std::string& source, const RecordingInfo& info, double step_s) {
  const std::size_t count = coordinate_count(info.kind);
  std::string text = fmt::format(
      "name = {}\nvendor_id = 0\nproduct_id = 0\n{}[report]\nminimum_size_bytes = {}\n"
      "byte_order = \"little\"\n[coordinates]\nkind = \"{}\"\noffset_bytes = 0\nwidth_bits = 64\n"
      "type = \"float\"\nunit = \"m\"\n",
      quoted(recording_name(source)),
      step_s > 0 ? fmt::format("rate_Hz = {:.6f}\n", 1 / step_s) : "",
      kBytes * (count + (info.has_drive ? 1 : 0)), name_of(info.kind));
  if (info.kind == SampleKind::pose) {
    text +=
        "[quaternion]\noffset_bytes = 24\nwidth_bits = 64\ntype = \"float\"\n"
        "order = [\"w\", \"x\", \"y\", \"z\"]\n";
  }
  if (info.has_drive) {
    text +=
        fmt::format("[drive]\noffset_bytes = {}\nwidth_bits = 64\ntype = \"float\"\nunit = \"N\"\n",
                    kBytes * count);
  }
  return text;
}

class Log {
 public:
  Log(const std::string& path, const hal::SessionHeader& header) : path_(path) {
    check(writer_.open(path, header));
  }
  void add(const hal::RawReport& report) {
    // write never waits.
    while (given_ - writer_.status().reports_written > kRingReports / 2) {
      check(writer_.status().failure);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (!writer_.write(0, report)) throw InputError(path_, "cannot be written", "free some space");
    ++given_;
  }
  void close() { check(writer_.close()); }

 private:
  void check(hal::SessionLogFailure failure) const {
    if (failure == hal::SessionLogFailure::none) return;
    throw InputError(path_, hal::session_log_failure_name(failure),
                     "name a folder with space in the variable TMPDIR");
  }
  std::string path_;
  hal::SessionLogWriter writer_{{.ring_reports = kRingReports, .chunk_time_ns = 20'000'000}};
  std::uint64_t given_ = 0;
};

hal::RawReport report_of(const Sample& sample, std::size_t count, bool has_drive) {
  hal::RawReport report;
  report.host_time_ns = sample.time_ns;
  const auto put = [&report](double value) {
    std::memcpy(report.bytes.data() + report.size, &value, kBytes);
    report.size += kBytes;
  };
  for (std::size_t i = 0; i < count; ++i) {
    put(sample.position_valid ? sample.coordinates[i] : std::numeric_limits<double>::quiet_NaN());
  }
  if (has_drive) {
    put(sample.drive_valid ? sample.drive_N : std::numeric_limits<double>::quiet_NaN());
  }
  return report;
}

}  // namespace

bool is_session_log(const std::string& path) {
  hal::SessionLogReader reader;
  return reader.open(path) == hal::Status::ok;
}

void write_as_session_log(const std::string& source, const std::string& log,
                          const std::function<bool()>& should_stop) {
  const double step_s = usual_step_s(source);
  const auto recording = open_recording(source, with_events());
  const RecordingInfo& info = recording->info();
  Sample sample;
  while (recording->next(sample) && !sample.time_valid) {
  }
  if (!sample.time_valid) throw InputError(source, "has no sample with a time", "record it again");
  hal::SessionHeader header;
  header.software_version = CONDYLE_VERSION;
  header.parameters_toml = info.parameters_toml;
  header.start_monotonic_ns = sample.time_ns;
  header.sources.push_back({"facebow", 0, 0, profile_of(source, info, step_s), {}});
  Log file(log, header);
  TimeNs last_ns = sample.time_ns;
  do {
    if (!sample.time_valid || sample.time_ns < last_ns) sample.time_ns = last_ns;
    last_ns = sample.time_ns;
    file.add(report_of(sample, coordinate_count(info.kind), info.has_drive));
  } while (!should_stop() && recording->next(sample));
  file.close();
}

}  // namespace condyle::host
