// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>

#include "hosted/files/clean_text.h"
#include "readings/readings_files.h"

namespace condyle::host {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr int kLabel = 12;

std::string line(std::string_view label, const std::string& words) {
  return fmt::format("{:<{}}{}\n", label, kLabel, clean_line(words));
}

std::string title_of(const JawReading& reading) {
  std::string title(reading.definition->name);
  if (reading.side != Side::none) title += fmt::format(", {}", name_of(reading.side));
  return title;
}

std::string value_of(const JawReading& reading) {
  const double half = (reading.high - reading.low) / 2;
  const int digits =
      half > 0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(half))), 0, 4) : 0;
  std::string text = fmt::format("{:>10.{}f}", reading.value, digits);
  if (half > 0) text += fmt::format(" +- {:.{}f}", half, digits);
  if (reading.definition->unit != "1") text += fmt::format(" {}", reading.definition->unit);
  if (reading.provenance == ReadingProvenance::derived) text += ", derived";
  return text;
}

}  // namespace

std::string samples_text(const PoseCounts& counts) {
  std::string text = fmt::format("{}", counts.samples);
  const auto add = [&text](std::uint64_t count, const char* what) {
    if (count > 0) text += fmt::format(", {} {}", count, what);
  };
  add(counts.missing, "missing");
  add(counts.not_rigid, "do not fit the body");
  add(counts.time_reversed, "run backwards in time");
  add(counts.in_bursts, "jump away from the path");
  add(counts.frozen, "frozen");
  return text;
}

std::string noise_text(const Analysis& analysis) {
  const auto& covariance = analysis.noise.covariance;
  std::string text = fmt::format("{:.3f} mm, {:.3f} deg (sd)",
                                 std::sqrt(covariance.topLeftCorner<3, 3>().trace() / 3) * 1e3,
                                 analysis.noise.rotation_sd_rad() / kDegree);
  if (analysis.noise.coloured > 1.5) text += "; smoothed by the instrument";
  if (analysis.noise.stamp_sd_s > 0) {
    text += fmt::format("; times off by {:.2g} ms (sd)", analysis.noise.stamp_sd_s * 1e3);
  }
  return text;
}

std::string analysis_text(const Analysis& analysis) {
  std::string text;
  text +=
      line("recording", fmt::format("{}, {}, {:.1f} s, {:.1f} samples a second", analysis.recording,
                                    analysis.info.format, analysis.duration_s, analysis.rate_Hz));
  text += line("usable", analysis.unusable.empty() ? "yes" : "no: " + analysis.unusable);
  text += line("samples", samples_text(analysis.counts));
  for (const auto* list : {&analysis.info.notes, &analysis.notes, &analysis.events}) {
    for (const std::string& note : *list) text += line("note", note);
  }
  text += line("reference", fmt::format("{:.2f} to {:.2f} s, {}", analysis.reference_begin_s,
                                        analysis.reference_end_s,
                                        analysis.is_reference_found ? "found" : "stated"));
  text += line("noise", noise_text(analysis));
  text += line("range", fmt::format("{:.1f} mm, {:.1f} deg", analysis.largest_displacement_mm,
                                    analysis.largest_rotation_deg));
  // Means, task by task; the same reason once.
  std::map<std::string, std::vector<std::string>> withheld;
  std::string task;
  for (const JawReading& reading : analysis.readings) {
    if (reading.stroke > 0) continue;
    if (reading.provenance == ReadingProvenance::withheld) {
      withheld[reading.reason].push_back(fmt::format("{}{}{}", name_of(reading.task),
                                                     *name_of(reading.task) != 0 ? " " : "",
                                                     title_of(reading)));
      continue;
    }
    const std::string name =
        reading.task == TaskKind::whole ? "whole recording" : name_of(reading.task);
    if (name != task) {
      int strokes = 0;
      for (const JawReading& other : analysis.readings) {
        if (other.task == reading.task) strokes = std::max(strokes, other.stroke);
      }
      bool is_found = false;
      for (const Task& one : analysis.tasks) is_found |= one.kind == reading.task && one.is_found;
      text += fmt::format("\n{}{}{}\n", name,
                          strokes > 1 ? fmt::format(", mean of {} strokes", strokes) : "",
                          is_found && reading.task != TaskKind::whole ? ", found" : "");
      task = name;
    }
    text += fmt::format("  {:<38}{}\n", title_of(reading), value_of(reading));
  }
  if (!withheld.empty()) text += "\nwithheld\n";
  for (const auto& [reason, titles] : withheld) {
    text += fmt::format("  {}:\n", clean_line(reason));
    std::string row;
    for (const std::string& title : titles) {
      if (!row.empty() && row.size() + title.size() > 88) {
        text += fmt::format("    {}\n", row);
        row.clear();
      }
      row += (row.empty() ? "" : "; ") + title;
    }
    text += fmt::format("    {}\n", row);
  }
  return text;
}

}  // namespace condyle::host
