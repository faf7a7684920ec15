// SPDX-License-Identifier: Apache-2.0
#include "recordings/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <mutex>
#include <set>

#include "hosted/devices/stream_spec.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "recordings/c3d.h"
#include "recordings/device_recording.h"
#include "recordings/exported_mcap.h"
#include "recordings/maker_tables.h"
#include "recordings/mat_check.h"
#include "recordings/mat_recording.h"
#include "recordings/named_points.h"
#include "recordings/recording_files.h"
#include "recordings/recording_formats.h"
#include "recordings/simulated_recording.h"
#include "recordings/text_fields.h"
#include "recordings/unit_watch.h"
#include "recordings/xdf_recording.h"

namespace condyle::host {
namespace {

constexpr std::string_view kFormats =
    "condyle reads CSV with named columns (time_s,position_m), C3D, TRC, TSV of Qualisys, CSV of "
    "Vicon and Motive, text of NDI, positions of Carstens, Motion-BIDS, MAT, XDF, ArtiSynth probe "
    "text, Zebris XML exports, SSFF, session logs (MCAP) and captures of USB traffic (pcap, "
    "pcapng)";

// Control characters that are not in the text formats; bytes from 0x80 on may be UTF-8.
bool is_text(std::string_view start) {
  return std::none_of(start.begin(), start.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && c != '\n' && c != '\r' && c != '\t' && c != '\f') || byte == 0x7f;
  });
}

// Whether the file is a device's profile, which must name a vendor, as no scenario does.
bool describes_device(const std::string& path) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (trim(line).starts_with("vendor_id")) return true;
  }
  return false;
}

}  // namespace

bool FaultRule::accept(NumberStatus status, const std::string& place, std::string_view column,
                       std::string_view text) const {
  const auto fail = [&](const std::string& problem, const std::string& mend) {
    throw InputError(fmt::format("{}: column {}", place, column), problem, mend);
  };
  constexpr const char* as_event = "correct the row, or count it as an event with --faults event";
  switch (status) {
    case NumberStatus::ok:
      return true;
    case NumberStatus::empty:
      if (policy_ == FaultPolicy::refuse) fail("the value is missing", as_event);
      return false;
    case NumberStatus::not_finite:
      if (policy_ == FaultPolicy::refuse) {
        fail(fmt::format("{} is not a finite number", quote(text)), as_event);
      }
      return false;
    case NumberStatus::overflow:
      fail(fmt::format("{} is larger than a number can hold", quote(text)), "correct the value");
      break;
    case NumberStatus::not_a_number:
      if (has_thousands(text)) {
        fail(fmt::format("{} has separators of thousands", quote(text)),
             "write the numbers without them, like 1234.5; a spreadsheet has this in the format of "
             "the cells");
      }
      if (text == column) {
        fail("the line repeats the names of the columns",
             "take it out; if another recording begins there, give it a file of its own");
      }
      fail(
          fmt::format("{} is not a number", quote(text)),
          policy_ == FaultPolicy::refuse
              ? "write numbers with a decimal point, like 0.0123; leave a missing value empty, and "
                "count it with --faults event"
              : "write numbers with a decimal point, like 0.0123; leave a missing value empty");
      break;
  }
  return false;
}

void split_row(std::string_view row, std::vector<std::string_view>& fields) {
  fields.clear();
  while (true) {
    const std::size_t comma = row.find(',');
    std::string_view field = trim(row.substr(0, comma));
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"') {
      field = field.substr(1, field.size() - 2);
    }
    fields.push_back(field);
    if (comma == std::string_view::npos) return;
    row.remove_prefix(comma + 1);
  }
}

bool RowReader::next(std::string_view& row) {
  if (!held_) {
    std::string_view line;
    std::uint64_t lines = 0;
    do {
      if (!reader_.next_line(line)) return false;
      const std::string_view text = trim(line);
      if (has_comments_ && (text.starts_with('#') || text.starts_with('%'))) continue;
      ++lines;
      if (!is_blank_row(text, separator_)) break;
    } while (true);
    held_ = line;
    blank_rows_ = lines - 1;
  }
  line_ = reader_.line_number() - blank_rows_;
  if (blank_rows_ > 0) {
    --blank_rows_;
    row = {};
  } else {
    row = *held_;
    held_.reset();
  }
  return true;
}

TimeNs regular_time_ns(TimeNs start_ns, std::uint64_t index, double step_s,
                       const std::string& path) {
  const double since_start_s = static_cast<double>(index) * step_s;
  if (!(seconds(start_ns) + since_start_s <= kFurthestTime_s)) {
    throw InputError(path,
                     fmt::format("row {} is {:.3g} s after the first", index + 1, since_start_s),
                     "check the start and the time step in its header");
  }
  return start_ns + nanoseconds(since_start_s);
}

SourceSpec recording_source(const std::string& text) {
  SourceSpec source = source_of(text);
  if (source.kind != SourceKind::synth || describes_device(source.file)) return source;
  source.kind = SourceKind::sim;
  static std::mutex mutex;
  static std::set<std::string> noted;
  const std::lock_guard lock(mutex);
  if (noted.insert(text).second) {
    const std::string note = fmt::format(
        "condyle: note: {} is a scenario; write sim:{}, because synth: takes the profile of a "
        "device\n",
        text, source.file);
    std::fputs(clean_lines(note).c_str(), stderr);
  }
  return source;
}

namespace {

// What the caller does with points that have names.
enum class PointUse { one_or_three, any, described };

std::unique_ptr<Recording> chosen(std::unique_ptr<NamedPointsRecording> recording,
                                  const RecordingOptions& options, PointUse use,
                                  const std::string& path) {
  if (use == PointUse::described && options.markers.empty()) return recording;
  const PointCount count =
      use == PointUse::one_or_three ? PointCount::one_or_three : PointCount::any;
  return with_markers(std::move(recording), options.markers, count, path);
}

std::unique_ptr<Recording> open_format(const std::string& path, const RecordingOptions& options,
                                       PointUse use) {
  auto reader = std::make_unique<ByteReader>(path);
  std::string_view start = reader->peek(4096);
  if (start.substr(0, 2) == "\xff\xfe" || start.substr(0, 2) == "\xfe\xff") {
    const bool is_big_endian = start[0] == '\xfe';
    reader->skip(2);
    reader->decode_utf16(is_big_endian);
    start = reader->peek(4096);
  }
  if (start.substr(0, 3) == "\xef\xbb\xbf") {
    reader->skip(3);
    start.remove_prefix(3);
  }
  if (start.empty()) throw InputError(path, "is empty", "give a file with a recording");
  const auto only_for = [&](bool used, const char* option, const char* format) {
    if (used) {
      throw InputError(path, fmt::format("{} applies only to {}", option, format), "leave it out");
    }
  };
  constexpr const char* kNamed = "formats whose points have names";
  const ReportFile report_file = report_file_of(start);
  const bool is_export = report_file == ReportFile::session_log && is_exported_mcap(path);
  const bool is_log = report_file == ReportFile::session_log && !is_export;
  const bool is_capture = report_file == ReportFile::capture;
  only_for(!options.profile.empty() && !is_log && !is_capture, "--profile",
           "session logs and captures");
  if (options.reads_drive_alone &&
      (is_log || is_capture || (!is_text(start) && !looks_like_mat(start)))) {
    throw InputError(path, "is not a CSV file",
                     "give the drive as CSV with time_s and drive_N, or as a session log");
  }
  const bool is_carstens = start.starts_with("AG50xDATA_V");
  const bool is_c3d = looks_like_c3d(*reader);
  start = reader->peek(4096);
  if (looks_like_mat(start)) {
    only_for(options.movement != 1, "--movement", "Zebris XML");
    reader.reset();
    auto table = open_mat(path, options, use != PointUse::one_or_three || !options.markers.empty());
    if (table->names().empty() && options.markers.empty()) return table;
    return chosen(std::move(table), options, use, path);
  }
  if (start.starts_with("XDF:")) {
    only_for(options.movement != 1, "--movement", "Zebris XML");
    only_for(options.rate_Hz.has_value(), "--rate-Hz", "files whose rows have no time");
    reader.reset();
    auto stream =
        open_xdf(path, options, use != PointUse::one_or_three || !options.markers.empty());
    if (stream->names().empty() && options.markers.empty()) return stream;
    return chosen(std::move(stream), options, use, path);
  }
  const bool is_ssff = start.starts_with("SSFF");
  const std::size_t first = start.find_first_not_of(" \t\r\n");
  const bool is_xml = first != std::string_view::npos && start[first] == '<';
  if (is_log || is_export || is_capture || is_ssff || is_xml || looks_like_probe_text(start) ||
      is_carstens || is_c3d) {
    only_for(!options.columns.empty(), "--columns", "CSV");
    only_for(options.rate_Hz.has_value(), "--rate-Hz", "files whose rows have no time");
  }
  if (is_log || is_capture) {
    only_for(options.movement != 1, "--movement", "Zebris XML");
    only_for(!options.ignored_columns.empty(), "--ignore-column", "CSV");
    only_for(!options.markers.empty(), "--marker", kNamed);
    only_for(options.units_per_metre.has_value(), "--unit", "formats whose columns state no unit");
    return is_log ? open_session_log(path, options) : open_capture(path, options);
  }
  if (is_export) {
    only_for(options.movement != 1, "--movement", "Zebris XML");
    only_for(!options.ignored_columns.empty(), "--ignore-column", "CSV");
    only_for(options.units_per_metre.has_value(), "--unit", "formats whose columns state no unit");
    auto points = open_exported_mcap(path);
    if (points->names().empty() && options.markers.empty()) return points;
    return chosen(std::move(points), options, use, path);
  }
  if (is_ssff) {
    only_for(options.movement != 1, "--movement", "Zebris XML");
    only_for(!options.ignored_columns.empty(), "--ignore-column", "CSV");
    only_for(!options.markers.empty(), "--marker", kNamed);
    return open_ssff(std::move(reader), options);
  }
  if (is_carstens || is_c3d) {
    only_for(options.movement != 1, "--movement", "Zebris XML");
    only_for(!options.ignored_columns.empty(), "--ignore-column", "CSV");
    auto points = is_carstens ? open_carstens(std::move(reader), options)
                              : open_c3d(std::move(reader), options);
    return chosen(std::move(points), options, use, path);
  }
  // XLSX and ODS are ZIP archives; XLS is a compound file of Microsoft.
  if (start.starts_with("PK\x03\x04") || start.starts_with("\xd0\xcf\x11\xe0")) {
    throw InputError(path, "is a workbook of a spreadsheet program, or an archive",
                     "save its table as CSV, or unpack it");
  }
  if (!is_text(start)) {
    throw InputError(path, "has an unknown binary format", std::string(kFormats));
  }
  if (is_xml) {
    only_for(!options.ignored_columns.empty(), "--ignore-column", "CSV");
    only_for(!options.markers.empty(), "--marker", kNamed);
    return open_zebris_xml(std::move(reader), options);
  }
  only_for(options.movement != 1, "--movement", "Zebris XML");
  if (start.find('\n') == std::string_view::npos && start.find('\r') != std::string_view::npos) {
    throw InputError(path, "its lines end in CR alone", "save it with LF or CR LF line ends");
  }
  if (looks_like_probe_text(start)) {
    only_for(!options.ignored_columns.empty(), "--ignore-column", "CSV");
    only_for(!options.markers.empty(), "--marker", kNamed);
    return open_probe_text(std::move(reader), options);
  }
  if (!options.reads_drive_alone) {
    if (auto table = open_maker_table(reader, options)) {
      if (table->names().empty() && options.markers.empty()) return table;  // poses
      return chosen(std::move(table), options, use, path);
    }
  }
  if (use == PointUse::one_or_three && options.markers.empty()) {
    return open_csv(std::move(reader), options);
  }
  auto points = open_csv_points(std::move(reader), options);
  if (points->names().empty() && options.markers.empty()) return points;
  return chosen(std::move(points), options, use, path);
}

std::unique_ptr<Recording> open_file(const std::string& path, const RecordingOptions& options,
                                     PointUse use) {
  std::unique_ptr<Recording> recording = open_format(path, options, use);
  // Their unit is not the user's to state.
  const bool is_in_metres =
      recording->info().is_of_device || recording->info().format == kExportedMcap;
  if (is_in_metres || options.reads_drive_alone) return recording;
  const bool is_decided = options.units_per_metre.has_value() || use == PointUse::described;
  return watch_unit(std::move(recording), is_decided ? UnitDoubt::note : UnitDoubt::refuse, path);
}

std::unique_ptr<Recording> open_source(const std::string& source, const RecordingOptions& options,
                                       PointUse use) {
  if (parse_stream(source)) {
    throw InputError(source, "is a stream, not a recording",
                     "record it first: condyle record '" + source + "' --out session.mcap");
  }
  const SourceSpec spec = recording_source(source);
  switch (spec.kind) {
    case SourceKind::file:
      break;
    case SourceKind::sim:
      return open_simulation(spec.file);
    case SourceKind::hid:
    case SourceKind::usb:
      throw InputError(
          source, "is a device, not a recording",
          fmt::format("record it first: condyle record --profile '{}' --backend {} --out "
                      "session.mcap",
                      spec.file, backend_of(spec.kind)));
    case SourceKind::synth:
      throw InputError(source, "is a synthetic device, which never ends",
                       "give a recording, or a simulated subject with sim:SCENARIO.toml");
  }
  if (recording_files(source).size() > 1) return open_joined(source, options);
  return open_file(spec.file, options, use);
}

}  // namespace

std::unique_ptr<Recording> open_recording(const std::string& source,
                                          const RecordingOptions& options) {
  return open_source(source, options, PointUse::one_or_three);
}

std::unique_ptr<Recording> open_with_all_points(const std::string& source,
                                                const RecordingOptions& options) {
  return open_source(source, options, PointUse::any);
}

std::unique_ptr<Recording> open_to_describe(const std::string& source,
                                            const RecordingOptions& options) {
  return open_source(source, options, PointUse::described);
}

std::unique_ptr<Recording> open_recording_file(const std::string& path,
                                               const RecordingOptions& options) {
  return open_file(path, options, PointUse::one_or_three);
}

}  // namespace condyle::host
