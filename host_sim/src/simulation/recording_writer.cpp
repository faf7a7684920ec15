// SPDX-License-Identifier: Apache-2.0
#include "simulation/recording_writer.h"

#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

void append_field(std::string& row, double value) {
  row += ',';
  append_number(row, value);
}

}  // namespace

std::string RecordingWriter::recording_header() const {
  if (!scenario_.facebow.gives_points) return "time_s,position_m\n";
  std::string header = "time_s";
  for (const char point : {'1', '2', '3'}) {
    for (const char axis : {'x', 'y', 'z'}) {
      header += std::string(",p") + point + "_" + axis + "_m";
    }
  }
  return header + "\n";
}

std::string_view RecordingWriter::recording_row(const Sample& sample) {
  row_.clear();
  append_time_s(row_, sample.time_ns);
  for (std::size_t i = 0; i < coordinate_count(sample.kind); ++i) {
    append_field(row_, sample.coordinates[i]);
  }
  return row_ += '\n';
}

std::string RecordingWriter::truth_header() const {
  const bool hinge = scenario_.subject.jaw.motion == JawMotion::hinge;
  std::string header = "time_s,position_m,velocity_m_s,acceleration_m_s2,";
  header += hinge ? "opening_rad,opening_rate_rad_s" : "displacement_m,displacement_rate_m_s";
  for (std::size_t i = 0; i < kCauses; ++i) {
    header += std::string(",") + cause_name(static_cast<Cause>(i)) + "_force_N";
  }
  header += ",drive_N";
  for (const Muscle& muscle : scenario_.subject.jaw.muscles)
    header += "," + muscle.name + "_activation";
  return header +
         ",effective_mass_kg,effective_friction_Ns_m,bristle_m,food_height_m,kinetic_energy_J\n";
}

std::string_view RecordingWriter::truth_row(const SubjectTruth& truth) {
  row_.clear();
  append_time_s(row_, nanoseconds(truth.time_s));
  for (const double value : {truth.position_m, truth.velocity_m_s, truth.acceleration_m_s2,
                             truth.coordinate, truth.coordinate_rate}) {
    append_field(row_, value);
  }
  for (const double force_N : truth.force_N) append_field(row_, force_N);
  append_field(row_, truth.drive_N());
  for (std::size_t n = 0; n < scenario_.subject.jaw.muscles.size(); ++n) {
    append_field(row_, truth.activation[n]);
  }
  for (const double value : {truth.effective_mass_kg, truth.effective_friction_Ns_m,
                             truth.bristle_m, truth.food_height_m, truth.kinetic_energy_J}) {
    append_field(row_, value);
  }
  return row_ += '\n';
}

std::string_view RecordingWriter::value_row(const Reading& reading) {
  row_.clear();
  append_time_s(row_, reading.time_ns);
  append_field(row_, reading.values[0]);
  return row_ += '\n';
}

std::string RecordingWriter::emg_header() const {
  std::string header = "time_s";
  for (const Muscle& muscle : scenario_.subject.jaw.muscles)
    header += "," + muscle.name + "_envelope";
  return header + "\n";
}

std::string_view RecordingWriter::emg_row(const Reading& reading) {
  row_.clear();
  append_time_s(row_, reading.time_ns);
  for (std::size_t n = 0; n < scenario_.subject.jaw.muscles.size(); ++n) {
    append_field(row_, reading.values[n]);
  }
  return row_ += '\n';
}

}  // namespace condyle::host
