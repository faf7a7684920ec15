// SPDX-License-Identifier: Apache-2.0
#include "exports/computed_series.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "exports/export_estimates.h"
#include "exports/jaw_poses.h"
#include "hosted/files/input_error.h"
#include "readings/analysis.h"
#include "readings/landmarks.h"
#include "readings/point_body.h"

namespace condyle::host {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr TimeNs kSameTime_ns = 1;  // times are rounded to it

// `name`, or if a series of the recording has that name another one.
std::string free_name(const ExportData& data, std::string name) {
  const auto is_taken = [&] {
    return std::any_of(data.series.begin(), data.series.end(),
                       [&](const ExportSeries& one) { return one.name == name; });
  };
  while (is_taken()) name += "_computed";
  return name;
}

// A quantity of the estimates, and its standard deviations.
class EstimatedQuantity {
 public:
  EstimatedQuantity(const char* quantity, const char* unit, std::vector<std::string> components,
                    std::string assumption, std::size_t samples) {
    value_ = {.name = kEstimateName,
              .quantity = quantity,
              .components = std::move(components),
              .unit = unit,
              .assumption = std::move(assumption),
              .values = {},
              .is_computed = true,
              .provenances = {}};
    value_.values.resize(samples * value_.components.size(), kMissing);
    sd_ = value_;
    sd_.quantity += "_sd";
    value_.provenances.resize(value_.values.size(), Provenance::not_computed);
  }

  void set(std::size_t k, std::size_t i, const Quantity<double>& quantity) {
    const std::size_t at = k * value_.components.size() + i;
    value_.values[at] = quantity.value;
    sd_.values[at] = quantity.standard_deviation;
    value_.provenances[at] = quantity.provenance;
  }

  void move_to(std::vector<ExportSeries>& series) {
    // The least that is known of any value stands for all where a format has room for one.
    Provenance least = Provenance::measured;
    for (const Provenance one : value_.provenances) {
      if (one != Provenance::not_computed) least = std::min(least, one);
    }
    value_.provenance = sd_.provenance = least;
    series.push_back(std::move(value_));
    series.push_back(std::move(sd_));
  }

 private:
  ExportSeries value_, sd_;
};

Eigen::Isometry3d isometry(const ExportPose& pose) {
  const double* const q = pose.orientation;
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
  result.translation() =
      Eigen::Vector3d(pose.position_m[0], pose.position_m[1], pose.position_m[2]);
  return result;
}

JawPoses poses_of(const ExportData& data, const char* what) {
  std::optional<JawPoses> poses = jaw_poses(data);
  if (!poses) {
    throw InputError(data.source, fmt::format("has no pose of the jaw, which {} needs", what),
                     "choose three points of the jaw, --marker A --marker B --marker C, that form "
                     "a triangle; or leave it out");
  }
  return *std::move(poses);
}

}  // namespace

void add_estimate_series(ExportData& data) {
  ExportEstimates& estimates = *data.estimates;
  const std::vector<std::string> axes = estimates.axis_count() == 1
                                            ? std::vector<std::string>{""}
                                            : std::vector<std::string>{"x", "y", "z"};
  const std::string how = "recommended estimator, no lag; " + estimates.followed();
  const std::string force_how =
      fmt::format("assumed mass of {:g} kg times acceleration", estimates.assumed_mass_kg());
  const std::size_t samples = data.samples();
  EstimatedQuantity position("position", "m", axes, how, samples),
      velocity("velocity", "m/s", axes, how, samples),
      acceleration("acceleration", "m/s^2", axes, how, samples),
      force("force", "N", axes, force_how, samples),
      friction("friction", "Ns/m", {""}, how, samples), mass("mass", "kg", {""}, how, samples);
  std::size_t k = 0, left_out = 0;
  estimates.run([&](const EstimateRow& row) {
    const bool is_in_order = row.time_ns && !row.events.has(Event::time_reversed);
    while (is_in_order && k < samples && data.time_ns[k] < *row.time_ns - kSameTime_ns) ++k;
    if (!is_in_order || k == samples || data.time_ns[k] > *row.time_ns + kSameTime_ns) {
      ++left_out;
      return;
    }
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const AxisEstimate<double>& axis = row.axes[i];
      position.set(k, i, axis.position_m);
      velocity.set(k, i, axis.velocity_m_s);
      acceleration.set(k, i, axis.acceleration_m_s2);
      force.set(k, i, axis.force_N);
    }
    friction.set(k, 0, row.friction_Ns_m);
    mass.set(k, 0, row.mass_kg);
  });
  for (EstimatedQuantity* one : {&position, &velocity, &acceleration, &force}) {
    one->move_to(data.series);
  }
  if (estimates.has_impedance()) {
    for (EstimatedQuantity* one : {&friction, &mass}) one->move_to(data.series);
  }
  if (left_out > 0) {
    data.notes.push_back(fmt::format(
        "{} estimates are left out: their times are not those of exported samples", left_out));
  }
}

void add_pose_series(ExportData& data) {
  const auto has_orientation = [](const ExportSeries& one) {
    return one.quantity == "orientation";
  };
  if (std::any_of(data.series.begin(), data.series.end(), has_orientation)) {
    data.notes.emplace_back("the recording holds poses: --pose adds none");
    return;
  }
  const JawPoses poses = poses_of(data, "--pose");
  ExportSeries place{.name = free_name(data, "jaw"),
                     .quantity = "position",
                     .components = {"x", "y", "z"},
                     .unit = "m",
                     .provenance = poses.provenance,
                     .assumption = poses.assumption,
                     .values = {},
                     .is_computed = true,
                     .provenances = {}};
  ExportSeries turn = place;
  turn.quantity = "orientation";
  turn.components = {"w", "x", "y", "z"};
  turn.unit.clear();
  for (const std::optional<ExportPose>& pose : poses.of_sample) {
    for (int i = 0; i < 3; ++i) place.values.push_back(pose ? pose->position_m[i] : kMissing);
    for (int i = 0; i < 4; ++i) turn.values.push_back(pose ? pose->orientation[i] : kMissing);
  }
  data.series.push_back(std::move(place));
  data.series.push_back(std::move(turn));
}

void add_landmark_series(const LandmarkChoice& choice, const RecordingOptions& reading,
                         ExportData& data) {
  const Landmarks landmarks = load_landmarks(choice.file);
  const JawPoses poses = poses_of(data, "--landmarks");
  AnalysisChoice analysed;
  analysed.reading = reading;
  analysed.landmarks = choice.file;
  analysed.reference_s = choice.reference_s;
  const Analysis analysis = analyse(data.source, analysed);
  if (!analysis.unusable.empty()) {
    throw InputError(data.source, analysis.unusable, "leave out --landmarks");
  }
  std::vector<Eigen::Isometry3d> at_rest;
  for (std::size_t k = 0; k < data.samples(); ++k) {
    const double time_s = seconds(data.time_ns[k]);
    const bool is_rest = time_s >= analysis.reference_begin_s && time_s <= analysis.reference_end_s;
    if (is_rest && poses.of_sample[k]) at_rest.push_back(isometry(*poses.of_sample[k]));
  }
  if (at_rest.empty()) {
    throw InputError(data.source, "has no pose in the reference position",
                     "state another one with --reference-s BEGIN END");
  }
  const Eigen::Isometry3d back = mean_pose(at_rest, 0, at_rest.size()).inverse(Eigen::Isometry);
  for (const auto point :
       {Landmarks::condyle_left, Landmarks::condyle_right, Landmarks::incisor_lower}) {
    ExportSeries series{
        .name = free_name(data, Landmarks::kNames[point]),
        .quantity = "position",
        .components = {"x", "y", "z"},
        .unit = "m",
        .provenance = Provenance::derived,
        .assumption = fmt::format("landmark, known to {:.2g} mm, moves with the jaw",
                                  landmarks.sd_m[point] * 1e3),
        .values = {},
        .is_computed = true,
        .provenances = {}};
    for (const std::optional<ExportPose>& pose : poses.of_sample) {
      Eigen::Vector3d place_m = Eigen::Vector3d::Constant(kMissing);
      if (pose) place_m = isometry(*pose) * (back * landmarks.point_m[point]);
      series.values.insert(series.values.end(), place_m.data(), place_m.data() + 3);
    }
    data.series.push_back(std::move(series));
  }
  data.notes.push_back(fmt::format(
      "landmarks hold in the reference position from {:.2f} to {:.2f} s{}, and move with the jaw",
      analysis.reference_begin_s, analysis.reference_end_s,
      analysis.is_reference_found ? ", which was found" : ""));
}

}  // namespace condyle::host
