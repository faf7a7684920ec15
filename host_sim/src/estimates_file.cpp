// SPDX-License-Identifier: Apache-2.0
#include "estimates_file.h"

#include <cmath>

#include "number_text.h"

namespace condyle::host {

EstimatesFile::EstimatesFile(const std::string& path) : file_(path) {
  file_.write(
      "time_s,position_m,velocity_m_s,force_N,friction_Ns_m,mass_kg,position_sd_m,velocity_sd_m_s,"
      "force_sd_N,friction_sd_Ns_m,mass_sd_kg,motion_nis,friction_nis,mass_nis,force_provenance,"
      "friction_provenance,mass_provenance,events\n");
}

void EstimatesFile::write_row(const Sample& sample, const PublishedEstimate<double>& estimate) {
  row_.clear();
  if (sample.time_valid) append_time_s(row_, sample.time_ns);
  const Quantity<double>* const quantities[] = {&estimate.position_m, &estimate.velocity_m_s,
                                                &estimate.force_N, &estimate.friction_Ns_m,
                                                &estimate.mass_kg};
  const auto append_field = [this](double value) {
    row_ += ',';
    append_number(row_, value);
  };
  for (const Quantity<double>* quantity : quantities) append_field(quantity->value);
  for (const Quantity<double>* quantity : quantities) append_field(quantity->standard_deviation);
  append_field(estimate.motion_nis);
  append_field(estimate.friction_nis);
  append_field(estimate.mass_nis);
  for (const Quantity<double>* quantity :
       {&estimate.force_N, &estimate.friction_Ns_m, &estimate.mass_kg}) {
    row_ += ',';
    row_ += provenance_name(quantity->provenance);
  }
  row_ += ',';
  bool first = true;
  for (std::size_t i = 0; i < kEventCount; ++i) {
    const auto event = static_cast<Event>(i);
    if (!estimate.events.has(event)) continue;
    if (!first) row_ += '|';
    row_ += event_name(event);
    first = false;
  }
  row_ += '\n';
  file_.write(row_);
}

}  // namespace condyle::host
