// SPDX-License-Identifier: Apache-2.0
#include "output/estimates_file.h"

#include <fmt/format.h>

#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

std::string header(int axis_count, bool has_joint) {
  std::string line =
      "time_s,position_m,velocity_m_s,force_N,friction_Ns_m,mass_kg,position_sd_m,velocity_sd_m_s,"
      "force_sd_N,friction_sd_Ns_m,mass_sd_kg,motion_nis,friction_nis,mass_nis,force_provenance,"
      "friction_provenance,mass_provenance,events";
  if (axis_count > 0) {
    line +=
        ",position_provenance,velocity_provenance,acceleration_provenance,acceleration_m_s2,"
        "acceleration_sd_m_s2,"
        "innovation_m,innovation_sd_m,noise_sd_m,jerk_density_m2_s5";
  }
  for (int axis = 0; axis_count == 3 && axis < 3; ++axis) {
    line += fmt::format(
        ",{0}_position_m,{0}_velocity_m_s,{0}_acceleration_m_s2,{0}_position_sd_m,"
        "{0}_velocity_sd_m_s,{0}_acceleration_sd_m_s2,{0}_position_provenance,"
        "{0}_velocity_provenance,{0}_acceleration_provenance",
        "xyz"[axis]);
  }
  if (has_joint) {
    line +=
        ",friction_limit,mass_limit,stiffness_N_m,stiffness_sd_N_m,stiffness_provenance,offset_N,"
        "offset_sd_N,offset_provenance,coulomb_N,coulomb_sd_N,coulomb_provenance,drive_delay_s,"
        "drive_delay_sd_s,drive_delay_provenance";
  }
  return line + '\n';
}

}  // namespace

EstimatesFile::EstimatesFile(const std::string& path, int axis_count, bool has_joint)
    : file_(path), axis_count_(axis_count), has_joint_(has_joint) {
  file_.write(header(axis_count, has_joint));
}

void EstimatesFile::append_field(double value) {
  row_ += ',';
  append_number(row_, value);
}

void EstimatesFile::append_field(const char* word) {
  row_ += ',';
  row_ += word;
}

void EstimatesFile::write_row(const EstimateRow& row) {
  row_.clear();
  if (row.time_ns) append_time_s(row_, *row.time_ns);
  const Quantity<double>* const quantities[] = {&row.position_m, &row.velocity_m_s, &row.force_N,
                                                &row.friction_Ns_m, &row.mass_kg};
  for (const Quantity<double>* quantity : quantities) append_field(quantity->value);
  for (const Quantity<double>* quantity : quantities) append_field(quantity->standard_deviation);
  append_field(row.motion_nis);
  append_field(row.friction_nis);
  append_field(row.mass_nis);
  for (const Quantity<double>* quantity : {&row.force_N, &row.friction_Ns_m, &row.mass_kg}) {
    append_field(provenance_name(quantity->provenance));
  }
  row_ += ',';
  bool first = true;
  for (std::size_t i = 0; i < kEventCount; ++i) {
    const auto event = static_cast<Event>(i);
    if (!row.events.has(event)) continue;
    if (!first) row_ += '|';
    row_ += event_name(event);
    first = false;
  }
  if (axis_count_ > 0) append_axes(row);
  if (has_joint_) append_joint(row.joint);
  row_ += '\n';
  file_.write(row_);
}

void EstimatesFile::append_axes(const EstimateRow& row) {
  append_field(provenance_name(row.position_m.provenance));
  append_field(provenance_name(row.velocity_m_s.provenance));
  append_field(provenance_name(row.followed.acceleration_m_s2.provenance));
  append_field(row.followed.acceleration_m_s2.value);
  append_field(row.followed.acceleration_m_s2.standard_deviation);
  append_field(row.followed.innovation_m);
  append_field(row.followed.innovation_sd_m);
  append_field(row.followed.noise_sd_m);
  append_field(row.followed.jerk_density_m2_s5);
  if (axis_count_ < 3) return;
  for (const AxisEstimate<double>& axis : row.axes) {
    const Quantity<double>* const quantities[] = {&axis.position_m, &axis.velocity_m_s,
                                                  &axis.acceleration_m_s2};
    for (const Quantity<double>* quantity : quantities) append_field(quantity->value);
    for (const Quantity<double>* quantity : quantities) append_field(quantity->standard_deviation);
    for (const Quantity<double>* quantity : quantities) {
      append_field(provenance_name(quantity->provenance));
    }
  }
}

void EstimatesFile::append_joint(const JointEstimate<double>& joint) {
  append_field(limit_name(joint.friction_Ns_m.limit));
  append_field(limit_name(joint.mass_kg.limit));
  for (const IdentifiedValue<double>* value :
       {&joint.stiffness_N_m, &joint.offset_N, &joint.coulomb_N, &joint.delay_s}) {
    append_field(value->quantity.value);
    append_field(value->quantity.standard_deviation);
    append_field(provenance_name(value->quantity.provenance));
  }
}

}  // namespace condyle::host
