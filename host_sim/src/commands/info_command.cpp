// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands/commands.h"
#include "hosted/files/clean_text.h"
#include "options/analysis_options.h"
#include "options/command_line.h"
#include "recordings/file_units.h"
#include "recordings/named_points.h"
#include "recordings/recording_description.h"

namespace condyle::host {
namespace {

using Json = nlohmann::ordered_json;

struct InfoOptions {
  std::string recording;
  RecordingOptions reading;
  bool as_json = false;
};

std::string line(const std::string& name, const std::string& text) {
  return fmt::format("{:<12}{}\n", name, clean_line(text));
}

// One name for each unit, however the file spells it.
std::string unit_text(const RecordingInfo& info) {
  const auto known = length_unit(info.stated.unit);
  return known ? known->name : info.stated.unit;
}

std::string name_text(const PointDescription& point) {
  return point.name.empty() ? "(without a name)" : clean_line(point.name);
}

std::string kind_text(const RecordingDescription& found) {
  if (found.axes == 1) return "position along one axis";
  if (found.info.kind == SampleKind::pose) return "place and orientation of one body";
  return fmt::format("{} marker{}", found.points.size(), found.points.size() == 1 ? "" : "s");
}

std::string point_text(const RecordingDescription& found, const PointDescription& point,
                       std::size_t width) {
  std::string text = fmt::format("  {:<{}}", name_text(point), width);
  if (!point.is_there(found.samples)) return text + "  never there\n";
  for (std::size_t axis = 0; axis < found.axes; ++axis) {
    text +=
        fmt::format("  {}{:.1f} to {:.1f}", found.axes == 1 ? "" : fmt::format("{} ", "xyz"[axis]),
                    point.low_m[axis] * 1e3, point.high_m[axis] * 1e3);
  }
  text += " mm";
  if (point.missing > 0) {
    text += fmt::format("; missing in {} of {} samples, {} gap{}, longest {}", point.missing,
                        found.samples, point.gaps, point.gaps == 1 ? "" : "s", point.longest_gap);
  }
  if (point.zeros > 0) text += fmt::format("; exactly 0 0 0 in {} samples", point.zeros);
  return text + "\n";
}

std::string description_text(const RecordingDescription& found) {
  const RecordingInfo& info = found.info;
  std::string text = line("format", info.format);
  if (!info.stated.maker.empty()) text += line("maker", info.stated.maker);
  text +=
      line("frames", fmt::format("{}{}, {:.6g} to {:.6g} s", found.samples,
                                 found.rate_Hz ? fmt::format(" at {:.6g} Hz", *found.rate_Hz) : "",
                                 found.first_s, found.last_s));
  if (!info.stated.unit.empty()) text += line("unit", unit_text(info));
  const auto count = [&](std::uint64_t number, const char* what) {
    if (number > 0) text += line("time", fmt::format("{} {}", number, what));
  };
  count(found.time_missing, "samples without a time");
  count(found.time_reversed, "samples not later than the one before");
  count(found.time_gaps, "steps longer than 1.5 times the usual one");
  text += line("holds", kind_text(found));
  std::size_t width = 0;
  for (const PointDescription& point : found.points) {
    width = std::max(width, name_text(point).size());
  }
  for (const PointDescription& point : found.points) text += point_text(found, point, width);
  if (info.has_drive) text += line("drive", fmt::format("{} samples", found.drive));
  if (!info.stated.channels.empty()) {
    text += line("analogue", fmt::format("{} channel{}", info.stated.channels.size(),
                                         info.stated.channels.size() == 1 ? "" : "s"));
  }
  for (const AnalogChannel& channel : info.stated.channels) {
    text +=
        fmt::format("  {}  {}, {:g} Hz\n", clean_line(channel.name),
                    channel.unit.empty() ? "no unit" : clean_line(channel.unit), channel.rate_Hz);
  }
  if (!info.stated.events.empty()) {
    text += line("events", fmt::format("{}", info.stated.events.size()));
  }
  for (const NamedInstant& event : info.stated.events) {
    text += fmt::format("  {:.3f} s  {}\n", event.time_s, clean_line(event.name));
  }
  for (const std::string& note : info.notes) text += line("note", note);
  return text;
}

std::string description_json(const RecordingDescription& found, const std::string& source) {
  const RecordingInfo& info = found.info;
  const auto or_null = [](const std::string& text) {
    return text.empty() ? Json(nullptr) : Json(clean_line(text));
  };
  Json names = Json::array(), points = Json::array(), channels = Json::array(),
       events = Json::array(), notes = Json::array();
  const bool has_markers = found.axes == 3 && info.kind != SampleKind::pose;
  for (const PointDescription& point : found.points) {
    if (has_markers) names.push_back(clean_line(point.name));
    Json range = nullptr;
    if (point.is_there(found.samples)) {
      range = Json::object();
      for (std::size_t axis = 0; axis < found.axes; ++axis) {
        range[found.axes == 1 ? "position" : std::string(1, "xyz"[axis])] = {
            point.low_m[axis] * 1e3, point.high_m[axis] * 1e3};
      }
    }
    points.push_back({{"name", clean_line(point.name)},
                      {"range_mm", range},
                      {"missing", point.missing},
                      {"gaps", point.gaps},
                      {"longest_gap", point.longest_gap},
                      {"zeros", point.zeros}});
  }
  for (const AnalogChannel& channel : info.stated.channels) {
    channels.push_back({{"name", clean_line(channel.name)},
                        {"unit", or_null(channel.unit)},
                        {"rate_Hz", channel.rate_Hz}});
  }
  for (const NamedInstant& event : info.stated.events) {
    events.push_back({{"time_s", event.time_s}, {"name", clean_line(event.name)}});
  }
  for (const std::string& note : info.notes) notes.push_back(clean_line(note));
  const Json json = {{"recording", clean_line(source)},
                     {"format", info.format},
                     {"maker", or_null(info.stated.maker)},
                     {"frames", found.samples},
                     {"rate_Hz", found.rate_Hz ? Json(*found.rate_Hz) : Json(nullptr)},
                     {"first_s", found.first_s},
                     {"last_s", found.last_s},
                     {"unit", or_null(unit_text(info))},
                     {"markers", names},
                     {"points", points},
                     {"analog", channels},
                     {"drive", found.drive},
                     {"events", events},
                     {"time_missing", found.time_missing},
                     {"time_reversed", found.time_reversed},
                     {"time_gaps", found.time_gaps},
                     {"notes", notes}};
  return json.dump(2) + "\n";
}

int run(const InfoOptions& options) {
  RecordingOptions reading = options.reading;
  reading.faults = FaultPolicy::event;  // what is missing is counted
  const auto recording = open_to_describe(options.recording, reading);
  const RecordingDescription found = describe_recording(*recording, stop_requested);
  if (stop_requested()) return report_stop();
  print_output(options.as_json ? description_json(found, options.recording)
                               : description_text(found));
  return kExitOk;
}

}  // namespace

Command add_info(CommandLine app) {
  auto options = std::make_shared<InfoOptions>();
  const CommandLine command =
      app.add_command("info", "Show what a recording holds, before anything is computed from it",
                      "Analyse recordings");
  command.add_example("condyle info jaw.csv",
                      "Show format, markers, analogue channels, gaps and ranges.");
  command.add_example("condyle info jaw.csv --json", "Print the same for programs.");
  command.add_option("RECORDING", options->recording, "As for replay").required();
  add_reading_options(command.group("What is read"), options->reading);
  command.add_flag("--json", options->as_json, "Print JSON, for programs");
  return [options] { return run(*options); };
}

}  // namespace condyle::host
