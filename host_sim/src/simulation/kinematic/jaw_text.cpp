// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/jaw_text.h"

#include <fmt/format.h>

#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

std::string number_text(double value) {
  std::string text;
  append_number(text, value);
  return text;
}

void append_field(std::string& text, double value) {
  text += ',';
  append_number(text, value);
}

}  // namespace

std::string jaw_recording_csv(const std::vector<Sample>& samples) {
  std::string text = "time_s";
  for (const char point : {'1', '2', '3'}) {
    for (const char axis : {'x', 'y', 'z'}) text += fmt::format(",p{}_{}_mm", point, axis);
  }
  text += '\n';
  for (const Sample& sample : samples) {
    append_time_s(text, sample.time_ns);
    for (const double coordinate_m : sample.coordinates) append_field(text, 1e3 * coordinate_m);
    text += '\n';
  }
  return text;
}

std::string jaw_poses_csv(const KinematicSimulation& simulation) {
  std::string text = "time_s";
  for (const char row : {'x', 'y', 'z'}) {
    for (const char column : {'x', 'y', 'z'}) text += fmt::format(",r_{}{}", row, column);
  }
  text += ",t_x_mm,t_y_mm,t_z_mm\n";
  for (std::size_t i = 0; i < simulation.samples().size(); ++i) {
    const JawPose pose = simulation.jaw().pose_at(simulation.instants_s()[i]);
    append_time_s(text, simulation.samples()[i].time_ns);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) append_field(text, pose.rotation(row, column));
    }
    for (int axis = 0; axis < 3; ++axis) append_field(text, 1e3 * pose.translation_m[axis]);
    text += '\n';
  }
  return text;
}

std::string jaw_landmarks_toml(const KinematicSimulation& simulation,
                               const LandmarkErrors& errors) {
  const JawLandmarks& points = simulation.stated_landmarks();
  std::string text = "[landmarks] # instrument's frame, mm, jaw in the reference position\n";
  const auto add = [&text](const char* name, const Eigen::Vector3d& point_m) {
    text += fmt::format("{} = [{}, {}, {}]\n", name, number_text(1e3 * point_m.x()),
                        number_text(1e3 * point_m.y()), number_text(1e3 * point_m.z()));
  };
  add("condyle_left", points.condyle_left);
  add("condyle_right", points.condyle_right);
  add("incisor_lower", points.incisor_lower);
  add("plane_left", points.plane_left);
  add("plane_right", points.plane_right);
  add("plane_front", points.plane_front);
  return text + fmt::format(
                    "condyle_sd_mm = {}\nincisor_sd_mm = {}\nplane_sd_mm = {}\n"
                    "kind = \"kinematic\"\nplane = \"Frankfurt\"\n",
                    number_text(errors.condyle_sd_mm), number_text(errors.incisor_sd_mm),
                    number_text(errors.plane_sd_mm));
}

std::string jaw_tasks_csv(const std::vector<JawTaskSpan>& tasks) {
  std::string text = "task,begin_s,end_s\n";
  for (const JawTaskSpan& task : tasks) {
    text += task.name();
    append_field(text, task.begin_s);
    append_field(text, task.end_s);
    text += '\n';
  }
  return text;
}

std::string jaw_readings_csv(const std::vector<TrueReading>& readings) {
  std::string text = "task,side,stroke,reading,value,unit\n";
  for (const TrueReading& one : readings) {
    text += fmt::format("{},{},{},{},{},{}\n", one.task, one.side, one.stroke, one.reading,
                        number_text(one.value), one.unit);
  }
  return text;
}

std::string jaw_cycles_csv(const std::vector<JawCycle>& cycles) {
  std::string text = "sequence,cycle,side,reversed,begin_s,opening_end_s,end_s\n";
  for (const JawCycle& cycle : cycles) {
    text += fmt::format("{},{},{},{:d}", cycle.sequence, cycle.cycle, jaw_side_name(cycle.working),
                        cycle.is_reversed);
    append_field(text, cycle.begin_s);
    append_field(text, cycle.opening_end_s);
    append_field(text, cycle.end_s);
    text += '\n';
  }
  return text;
}

}  // namespace condyle::host
