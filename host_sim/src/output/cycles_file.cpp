// SPDX-License-Identifier: Apache-2.0
#include "output/cycles_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hosted/files/number_text.h"

namespace condyle::host {

CyclesFile::CyclesFile(const std::string& path) : file_(path) {
  std::string header =
      "sequence,cycle,begin_s,turn_s,end_s,known_s,begins_after_pause,ends_with_pause";
  visit_cycle({}, [&header](QuantityName name, const Quantity<double>&) {
    for (const std::string& column : {name.value(), name.standard_deviation(), name.provenance()}) {
      (header += ',') += column;
    }
  });
  file_.write(header + ",rejected\n");
}

void CyclesFile::write_row(const Row& row) {
  const MotionCycle<double>& cycle = row.cycle;
  std::string text =
      fmt::format("{},{}", row.sequence, row.number > 0 ? std::to_string(row.number) : "");
  for (const TimeNs time_ns : {cycle.begin_ns, cycle.turn_ns, cycle.end_ns, cycle.known_ns}) {
    append_time_s(text += ',', time_ns);
  }
  text += fmt::format(",{:d},{:d}", cycle.begins_after_pause, cycle.ends_with_pause);
  visit_cycle(cycle, [&text](QuantityName, const Quantity<double>& quantity) {
    append_number(text += ',', quantity.value);
    append_number(text += ',', quantity.standard_deviation);
    (text += ',') += provenance_name(quantity.provenance);
  });
  file_.write(text + "," + rejection_text(cycle) + "\n");
}

void CyclesSummary::add(const FoundCycle& cycle) {
  if (cycle.number == 0) {
    ++rejected_;
    return;
  }
  ++taken_;
  const double duration_s = cycle.cycle.duration_s.value;
  sum_s_ += duration_s;
  squares_s2_ += duration_s * duration_s;
}

double CyclesSummary::sd_s() const {
  return std::sqrt(std::max((squares_s2_ - sum_s_ * mean_s()) / (taken_ - 1), 0.0));
}

std::string CyclesSummary::text() const {
  std::string text = fmt::format("{} taken, {} not taken", taken_, rejected_);
  if (taken_ < 2) return text;
  return text + fmt::format("; mean duration {:.3g} s, standard deviation among them {:.2g} s",
                            mean_s(), sd_s());
}

nlohmann::ordered_json CyclesSummary::json() const {
  using Json = nlohmann::ordered_json;
  const bool has_mean = taken_ >= 2;
  return {{"taken", taken_},
          {"not_taken", rejected_},
          {"mean_duration_s", has_mean ? Json(mean_s()) : Json()},
          {"duration_sd_among_cycles_s", has_mean ? Json(sd_s()) : Json()}};
}

}  // namespace condyle::host
