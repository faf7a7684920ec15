// SPDX-License-Identifier: Apache-2.0
// What is written of a kinematic jaw, as text: CSV with units in the column names, and TOML.
#pragma once

#include <string>
#include <vector>

#include "simulation/kinematic/kinematic_simulation.h"

namespace condyle::host {

/// time_s,p1_x_mm,...,p3_z_mm
std::string jaw_recording_csv(const std::vector<Sample>& samples);
/// The true pose at each sample: its reported time, rotation r_xx...r_zz (row by row), translation.
std::string jaw_poses_csv(const KinematicSimulation& simulation);
/// [landmarks] as an examiner states them, with the standard deviations of their errors.
std::string jaw_landmarks_toml(const KinematicSimulation& simulation, const LandmarkErrors& errors);
/// task,begin_s,end_s
std::string jaw_tasks_csv(const std::vector<JawTaskSpan>& tasks);
/// task,side,stroke,reading,value,unit
std::string jaw_readings_csv(const std::vector<TrueReading>& readings);
/// sequence,cycle,side,reversed,begin_s,opening_end_s,end_s
std::string jaw_cycles_csv(const std::vector<JawCycle>& cycles);

}  // namespace condyle::host
