// SPDX-License-Identifier: Apache-2.0
#include "readings/readings_files.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "hosted/files/clean_text.h"

namespace condyle::host {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// Our own words without commas, so that a simple reader need not know of quotes.
std::string without_commas(std::string text) {
  std::replace(text.begin(), text.end(), ',', ';');
  return csv_field(text);
}

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.9g}", value) : std::string();
}

nlohmann::ordered_json json_number(double value) {
  if (!std::isfinite(value)) return nullptr;
  return value;
}

std::string with_half_interval(const UncertainValue& value) {
  if (!std::isfinite(value.value)) return ",,";
  return fmt::format(",{},{}", number(value.value), number(value.half_interval()));
}

// Where a loop of this area closes; empty if that is not known.
const char* loop_text(const UncertainValue& area, const char* positive, const char* negative) {
  const double half = area.half_interval();
  return area.value > half ? positive : area.value < -half ? negative : "";
}

}  // namespace

std::string readings_csv(const std::vector<Analysis>& analyses) {
  std::string text =
      "recording,task,side,stroke,reading,value,low,high,unit,definition,provenance,reason\n";
  for (const Analysis& analysis : analyses) {
    for (const JawReading& reading : analysis.readings) {
      text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_field(analysis.recording),
                          name_of(reading.task), name_of(reading.side),
                          reading.stroke > 0 ? std::to_string(reading.stroke) : "",
                          reading.definition->name, number(reading.value), number(reading.low),
                          number(reading.high), reading.definition->unit,
                          without_commas(std::string(reading.definition->definition)),
                          name_of(reading.provenance), without_commas(reading.reason));
    }
  }
  return text;
}

std::string readings_json(const std::vector<Analysis>& analyses) {
  nlohmann::ordered_json all = {{"format", "condyle-readings-1"},
                                {"condyle", CONDYLE_VERSION},
                                {"note", "research use only; not a diagnosis"},
                                {"recordings", nlohmann::ordered_json::array()}};
  for (const Analysis& analysis : analyses) {
    nlohmann::ordered_json one = {
        {"recording", clean_line(analysis.recording)},
        {"format", clean_line(analysis.info.format)},
        {"usable", analysis.unusable.empty()},
        {"reason", analysis.unusable},
        {"duration_s", analysis.duration_s},
        {"rate_Hz", analysis.rate_Hz},
        {"reference_s", {analysis.reference_begin_s, analysis.reference_end_s}},
        {"reference", analysis.is_reference_found ? "found" : "stated"},
        {"rotation_noise_sd_deg", analysis.noise.rotation_sd_rad() / kDegree},
        {"position_noise_sd_mm",
         std::sqrt(analysis.noise.covariance.topLeftCorner<3, 3>().trace() / 3) * 1e3},
        {"time_error_sd_s", analysis.noise.stamp_sd_s},
        {"samples", analysis.counts.samples},
        {"samples_not_used", analysis.counts.missing + analysis.counts.not_rigid +
                                 analysis.counts.time_reversed + analysis.counts.in_bursts +
                                 analysis.counts.frozen}};
    one["notes"] = nlohmann::ordered_json::array();
    for (const auto* list : {&analysis.info.notes, &analysis.notes, &analysis.events}) {
      for (const std::string& note : *list) one["notes"].push_back(clean_line(note));
    }
    one["tasks"] = nlohmann::ordered_json::array();
    for (const Task& task : analysis.tasks) {
      one["tasks"].push_back({{"task", name_of(task.kind)},
                              {"begin_s", task.begin_s},
                              {"end_s", task.end_s},
                              {"found", task.is_found}});
    }
    one["average_cycles"] = nlohmann::ordered_json::array();
    for (const AverageCycle& average : analysis.average_cycles) {
      one["average_cycles"].push_back(
          {{"side", average.side},
           {"cycles", average.cycles},
           {"known", average.withheld.empty()},
           {"reason", average.withheld.empty() ? average.assumed : average.withheld}});
    }
    one["readings"] = nlohmann::ordered_json::array();
    for (const JawReading& reading : analysis.readings) {
      one["readings"].push_back(
          {{"task", name_of(reading.task)},
           {"side", name_of(reading.side)},
           {"stroke", reading.stroke > 0 ? nlohmann::ordered_json(reading.stroke) : nullptr},
           {"reading", reading.definition->name},
           {"value", json_number(reading.value)},
           {"low", json_number(reading.low)},
           {"high", json_number(reading.high)},
           {"unit", reading.definition->unit},
           {"definition", reading.definition->definition},
           {"provenance", name_of(reading.provenance)},
           {"reason", clean_line(reading.reason)}});
    }
    all["recordings"].push_back(std::move(one));
  }
  return all.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string cycles_csv(const std::vector<Analysis>& analyses) {
  // Those without landmarks have fewer columns of values.
  const auto names = readings_of_cycle(true);
  std::string text = "recording,sequence,cycle,begin_s,turn_s,end_s";
  for (const auto name : names) text += fmt::format(",{},{}_half_interval", name, name);
  text +=
      ",side,side_from,closing_side_mm,closing_side_mm_half_interval,frontal_loop,sagittal_loop,"
      "rejected,assumed\n";
  for (const Analysis& analysis : analyses) {
    for (const AnalysedCycle& cycle : analysis.cycles) {
      text += fmt::format("{},{},{},{:.6f},{:.6f},{:.6f}", csv_field(analysis.recording),
                          cycle.sequence, cycle.number > 0 ? std::to_string(cycle.number) : "",
                          cycle.cycle.begin_s, cycle.cycle.turn_s, cycle.cycle.end_s);
      for (std::size_t i = 0; i < names.size(); ++i) {
        const bool has = i < cycle.values.size();
        text += has ? with_half_interval(cycle.values[i]) : ",,";
      }
      const CycleDirections& directions = cycle.directions;
      text +=
          fmt::format(",{},{}{},{},{},{},{}\n", cycle.side,
                      cycle.side.empty()     ? ""
                      : cycle.is_side_stated ? "stated"
                                             : "closing path",
                      with_half_interval(directions.closing_side_mm),
                      loop_text(directions.frontal_area_mm2, "closes left", "closes right"),
                      loop_text(directions.sagittal_area_mm2, "closes in front", "closes behind"),
                      without_commas(cycle.cycle.rejected), without_commas(cycle.assumed));
    }
  }
  return text;
}

std::string average_cycle_csv(const std::vector<Analysis>& analyses) {
  std::string text = "recording,side,cycles,phase,share,time_s";
  for (const char axis : {'x', 'y', 'z'}) {
    text += fmt::format(",{0}_mm,{0}_sd_mm,{0}_half_interval_mm", axis);
  }
  text += ",reason\n";
  for (const Analysis& analysis : analyses) {
    for (const AverageCycle& average : analysis.average_cycles) {
      const std::string begin =
          fmt::format("{},{},{}", csv_field(analysis.recording), average.side, average.cycles);
      if (!average.withheld.empty()) {
        text += fmt::format("{},,,{},{}\n", begin, std::string(9, ','),
                            without_commas(average.withheld));
      }
      for (const AverageCycle::Point& point : average.points) {
        text += fmt::format("{},{},{:.6f},{:.6f}", begin, point.is_closing ? "closing" : "opening",
                            point.share, point.time_s);
        for (int axis = 0; axis < 3; ++axis) {
          text += fmt::format(",{:.5f},{:.5f},{:.5f}", point.mean_mm[axis], point.sd_mm[axis],
                              point.half_interval_mm[axis]);
        }
        text += "," + without_commas(average.assumed) + "\n";
      }
    }
  }
  return text;
}

void write_poses(const Analysis& analysis, OutputFile& file) {
  const JawPath& path = analysis.path;
  const char* const followed = analysis.has_landmarks ? "incisor" : "point1";
  std::string header = "time_s";
  for (const char axis : {'x', 'y', 'z'}) header += fmt::format(",{}_{}_mm", followed, axis);
  header += fmt::format(",{}_sd_mm", followed);
  for (const char axis : {'x', 'y', 'z'}) header += fmt::format(",{}_v{}_mm_s", followed, axis);
  for (const char axis : {'x', 'y', 'z'}) header += fmt::format(",rotation_{}_deg", axis);
  if (analysis.has_landmarks) {
    for (const char* side : {"left", "right"}) {
      for (const char axis : {'x', 'y', 'z'})
        header += fmt::format(",condyle_{}_{}_mm", side, axis);
    }
  }
  file.write(header + "\n");
  fmt::memory_buffer row;
  const auto add_one = [&row](double value) {
    fmt::format_to(fmt::appender(row), FMT_COMPILE(",{:.5f}"), value);
  };
  const auto add = [&add_one](const Eigen::Vector3d& values, double scale) {
    for (const double value : values) add_one(value * scale);
  };
  for (std::size_t k = 0; k < path.time_s.size(); ++k) {
    row.clear();
    fmt::format_to(fmt::appender(row), FMT_COMPILE("{:.6f}"), path.time_s[k]);
    add(path.incisor_m[k], 1e3);
    add_one(analysis.incisor_sd_m[k] * 1e3);
    add(path.incisor_m_s[k], 1e3);
    add(path.rotation_rad[k], 1 / kDegree);
    if (analysis.has_landmarks) {
      add(path.condyle_m[0][k], 1e3);
      add(path.condyle_m[1][k], 1e3);
    }
    row.push_back('\n');
    file.write({row.data(), row.size()});
  }
}

}  // namespace condyle::host
