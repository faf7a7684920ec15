// SPDX-License-Identifier: Apache-2.0
// Recordings of the kinematic jaw, analysed and held against its true readings.
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "condyle/estimator/pose/rotation_vector.h"
#include "readings/analysis.h"
#include "simulation/kinematic/kinematic_simulation.h"

namespace condyle::host {

/// Samples as a recording.
class SampleRecording final : public Recording {
 public:
  explicit SampleRecording(const std::vector<Sample>& samples) : samples_(samples) {
    info_.format = "simulation";
    info_.kind = samples.empty() ? SampleKind::three_points : samples[0].kind;
  }
  bool next(Sample& sample) override {
    if (next_ == samples_.size()) return false;
    sample = samples_[next_++];
    return true;
  }
  const RecordingInfo& info() const override { return info_; }
  std::string place() const override { return "simulation"; }
  double progress() const override { return 0; }

 private:
  const std::vector<Sample>& samples_;
  RecordingInfo info_;
  std::size_t next_ = 0;
};

/// The landmarks that an examiner states.
inline Landmarks stated_landmarks(const KinematicSimulation& simulation,
                                  const LandmarkErrors& errors) {
  const JawLandmarks& stated = simulation.stated_landmarks();
  Landmarks landmarks;
  landmarks.point_m = {stated.condyle_left, stated.condyle_right, stated.incisor_lower,
                       stated.plane_left,   stated.plane_right,   stated.plane_front};
  for (int i = 0; i < 6; ++i) {
    landmarks.sd_m[static_cast<std::size_t>(i)] = 1e-3 * (i < 2    ? errors.condyle_sd_mm
                                                          : i == 2 ? errors.incisor_sd_mm
                                                                   : errors.plane_sd_mm);
  }
  return landmarks;
}

/// The tasks with their true times, stated.
inline std::vector<Task> stated_tasks(const KinematicSimulation& simulation) {
  std::vector<Task> tasks;
  for (const JawTaskSpan& span : simulation.tasks()) {
    tasks.push_back({task_kind(span.name(), "simulation"), span.begin_s, span.end_s, false});
  }
  return tasks;
}

/// The analysis of a jaw whose incisor goes up and down as `height_m` says (m, of the time in s),
/// without turning: rests of `rest_s` at 0 m before and after `chewing_s` of chewing. Each
/// coordinate of its three points has noise of `noise_m`.
inline Analysis analysis_of_heights(const std::function<double(double)>& height_m, double rest_s,
                                    double chewing_s, double rate_Hz, double noise_m) {
  JawScenario scenario;
  scenario.tasks = {default_task(JawTaskKind::rest)};
  scenario.facebow.noise_m = scenario.facebow.noise_rad = 0;
  scenario.landmarks = {1e-4, 1e-4, 1e-4};
  const KinematicSimulation simulation(scenario, 1);
  const Sample still = simulation.samples().front();
  const JawLandmarks& points = simulation.stated_landmarks();
  const Eigen::Vector3d up = (points.plane_left - points.plane_front)
                                 .cross(points.plane_right - points.plane_front)
                                 .normalized();
  const double sign = up.dot(points.condyle_left - points.incisor_lower) > 0 ? 1 : -1;
  RandomGenerator random(1, 1);
  std::vector<Sample> samples;
  const double length_s = 2 * rest_s + chewing_s;
  for (int k = 0; k < length_s * rate_Hz; ++k) {
    const double time_s = k / rate_Hz;
    Sample sample = still;
    sample.time_ns = std::llround(1e9 * time_s);
    const Eigen::Vector3d shift = sign * height_m(time_s) * up;
    for (int i = 0; i < 9; ++i) {
      sample.coordinates[static_cast<std::size_t>(i)] += shift[i % 3] + noise_m * random.normal();
    }
    samples.push_back(sample);
  }
  SampleRecording recording(samples);
  AnalysisChoice choice;
  choice.tasks = {{TaskKind::rest, 0.1, rest_s - 0.1, false},
                  {TaskKind::chewing, rest_s - 0.5, length_s - rest_s + 0.5, false}};
  return analyse(recording, "simulation", stated_landmarks(simulation, scenario.landmarks), choice);
}

/// The exact path of `jaw`, at 2 kHz by default.
inline JawPath exact_path(const KinematicJaw& jaw, double begin_s, double end_s,
                          double step_s = 0.0005) {
  const JawLandmarks& points = jaw.landmarks();
  ReadingGeometry geometry;
  geometry.has_landmarks = true;
  geometry.head.translation() = (points.condyle_left + points.condyle_right) / 2;
  geometry.incisor_m = points.incisor_lower;
  geometry.condyle_m = {points.condyle_left, points.condyle_right};
  geometry.middle_m = Eigen::Vector3d(0.1, 0, -0.05);
  SmoothMotion motion;
  const auto at = [&](double time_s) {
    const JawPose pose = jaw.pose_at(time_s);
    Vector6 value;
    value << pose.rotation * geometry.middle_m + pose.translation_m - geometry.middle_m,
        rotation_vector_of<double>(pose.rotation);
    return value;
  };
  for (double time_s = begin_s; time_s < end_s; time_s += step_s) {
    motion.time_s.push_back(time_s);
    motion.value.push_back(at(time_s));
    motion.slope.push_back((at(time_s + 1e-5) - at(time_s - 1e-5)) / 2e-5);
  }
  JawPath path;
  path.is_exact = true;
  paths_of(motion, geometry, path);
  return path;
}

/// Counts of one reading over many recordings.
struct Coverage {
  int wanted = 0, shown = 0, covered = 0;
  double sum = 0, squares = 0, halves = 0;  ///< of the error; of half intervals
};

/// "task/side/reading" of the mean over strokes.
using Coverages = std::map<std::string, Coverage>;

inline std::string coverage_key(const std::string& task, const std::string& side,
                                const std::string& reading) {
  return task + "/" + side + "/" + reading;
}

/// Adds the means of `analysis` to `coverages`. The share of covered ones among those shown.
inline double compare_means(const Analysis& analysis, const std::vector<TrueReading>& truth,
                            Coverages& coverages) {
  std::map<std::string, double> values;
  for (const TrueReading& reading : truth) {
    if (reading.stroke == 0) {
      values[coverage_key(reading.task, reading.side, reading.reading)] = reading.value;
    }
  }
  int shown = 0, covered = 0;
  for (const JawReading& reading : analysis.readings) {
    if (reading.stroke > 0) continue;
    const std::string key = coverage_key(name_of(reading.task), name_of(reading.side),
                                         std::string(reading.definition->name));
    const auto truth_of = values.find(key);
    if (truth_of == values.end()) continue;
    Coverage& coverage = coverages[key];
    ++coverage.wanted;
    if (reading.provenance == ReadingProvenance::withheld) continue;
    const double error = reading.value - truth_of->second;
    const bool is_covered = reading.low <= truth_of->second && truth_of->second <= reading.high;
    ++shown;
    covered += is_covered;
    ++coverage.shown;
    coverage.covered += is_covered;
    coverage.sum += error;
    coverage.squares += error * error;
    coverage.halves += (reading.high - reading.low) / 2;
  }
  return shown == 0 ? 0 : static_cast<double>(covered) / shown;
}

}  // namespace condyle::host
