// SPDX-License-Identifier: Apache-2.0
#include "readings/body_tracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "hosted/files/input_error.h"
#include "hosted/files/nearest_word.h"
#include "readings/number_step.h"
#include "readings/pose_noise.h"
#include "recordings/point_list.h"

namespace condyle::host {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;

// Samples whose missing points multiply the variance by more are not used.
constexpr double kMostGrowth = 4;
constexpr double kGrowthWindow_s = 0.5;
constexpr double kMostResidual_m = 0.15e-3;

// What a body shows by itself: whether its points keep their distances, against its own noise.
std::string rigidity_problem(const BodyPoses& body, const std::vector<double>& time_s,
                             const std::string& what) {
  PoseTrack track;
  for (std::size_t k = 0; k < time_s.size(); ++k) {
    if (!body.fits[k].is_fitted) continue;
    track.time_s.push_back(time_s[k]);
    track.pose.push_back(body.fits[k].pose);
  }
  if (track.time_s.size() < kLeastSamples) return "";  // refused later
  const PoseNoise noise = noise_of(motion_from(track, 0, 1, MovingBody::lower), 0, 0);
  const double noise_m = std::sqrt(noise.covariance.topLeftCorner<3, 3>().trace() / 3);
  // n points of noise s, each coordinate: the residual is s sqrt(3 - 6/n), the middle's noise
  // s / sqrt(n), and so the residual sqrt(3) sqrt(n - 2) times that; more than three times that for
  // 90 % of the samples is not noise.
  const auto points = static_cast<double>(body.body.shape_m.cols());
  if (body.body.residual_m <= std::max(kMostResidual_m, 6 * noise_m * std::sqrt(points - 2))) {
    return "";
  }
  return fmt::format("the points of the {} do not keep their distances (they misfit by {:.2f} mm)",
                     what, body.body.residual_m * 1e3);
}

// The greatest mean of `growth` over kGrowthWindow_s.
double greatest_mean(const std::vector<double>& time_s, const std::vector<double>& growth) {
  double greatest = 1, sum = 0;
  std::size_t first = 0;
  for (std::size_t k = 0; k < growth.size(); ++k) {
    sum += growth[k] - 1;
    while (time_s[k] - time_s[first] > kGrowthWindow_s) sum -= growth[first++] - 1;
    greatest = std::max(greatest, 1 + sum / static_cast<double>(k + 1 - first));
  }
  return greatest;
}

std::string list(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

std::vector<std::string> others(const std::vector<std::string>& names,
                                const std::vector<std::string>& than) {
  std::vector<std::string> rest;
  for (const std::string& name : names) {
    if (std::find(than.begin(), than.end(), name) == than.end()) rest.push_back(name);
  }
  return rest;
}

void describe(const std::string& what, const BodyPoses& body, PoseTrack& track) {
  track.notes.push_back(
      fmt::format("{}: {} points, {}; they misfit by {:.3f} mm in 90 % of samples", what,
                  body.body.names.size(), list(body.body.names), body.body.residual_m * 1e3));
  if (body.too_few > 0) {
    track.notes.push_back(
        fmt::format("{} samples have too few points of the {}", body.too_few, what));
  }
}

}  // namespace

std::vector<std::string> point_names(const std::string& text, const std::string& option,
                                     std::size_t least) {
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    names.push_back(text.substr(begin, comma - begin));
    begin = comma + 1;
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) {
      throw InputError(option, "one of its names is empty",
                       "give names with commas and without spaces, such as A,B,C");
    }
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) !=
        names.begin() + static_cast<std::ptrdiff_t>(i)) {
      throw InputError(option, fmt::format("names the point {} twice", names[i]),
                       "name each point once");
    }
  }
  if (names.size() < least || names.size() > kMostBodyPoints) {
    throw InputError(option,
                     fmt::format("names {} point{}", names.size(), names.size() == 1 ? "" : "s"),
                     fmt::format("name {} to {} points of one rigid body, such as A,B,C", least,
                                 kMostBodyPoints));
  }
  return names;
}

std::vector<Index> points_by_name(const std::vector<std::string>& wanted,
                                  const std::vector<std::string>& names,
                                  const std::string& option) {
  std::vector<Index> numbers;
  for (const std::string& name : wanted) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      const std::string nearest = nearest_word(name, names);
      throw InputError(
          option, fmt::format("the recording has no point {}", name),
          fmt::format("{}its points are {}",
                      nearest.empty() ? "" : "did you mean " + nearest + "? ", list(names)));
    }
    numbers.push_back(found - names.begin());
  }
  return numbers;
}

NamedPoints read_named_points(Recording& recording, const std::string& name) {
  NamedPoints points;
  const auto* const named = dynamic_cast<const NamedPointsRecording*>(&recording);
  if (named != nullptr) points.names = named->names();
  Sample sample;
  while (recording.next(sample)) {
    ++points.counts.samples;
    if (!sample.time_valid) {
      ++points.counts.missing;
      continue;
    }
    const double time_s = seconds(sample.time_ns);
    if (!points.time_s.empty() && time_s <= points.time_s.back()) {
      ++points.counts.time_reversed;
      continue;
    }
    points.time_s.push_back(time_s);
    if (named != nullptr) {
      points.points_m.push_back(named->points_m());
    } else if (sample.kind == SampleKind::three_points || sample.kind == SampleKind::one_point) {
      PointColumns& own_m = points.points_m.emplace_back(
          PointColumns::Map(sample.coordinates, 3, sample.kind == SampleKind::one_point ? 1 : 3));
      if (!sample.position_valid) own_m.setConstant(std::nan(""));
    } else {
      points.time_s.clear();
      break;
    }
  }
  points.info = recording.info();
  if (named == nullptr && !points.points_m.empty()) {
    points.names = {"p1", "p2", "p3"};
    points.names.resize(static_cast<std::size_t>(points.points_m[0].cols()));
  }
  if (points.names.empty()) {
    throw InputError(name, "has no points",
                     "give a recording with points, such as CSV with A_x_mm");
  }
  return points;
}

BodyPoses fit_body(const NamedPoints& points, const std::vector<std::string>& wanted,
                   const std::string& body, const std::string& option, const std::string& name) {
  const std::vector<Index> numbers = points_by_name(wanted, points.names, option);
  std::vector<PointColumns> own_m;
  own_m.reserve(points.points_m.size());
  for (const PointColumns& all_m : points.points_m) own_m.push_back(all_m(Eigen::all, numbers));
  refuse_if_short(own_m.size(), points.counts, name);
  const PointBody shape(own_m, wanted, fmt::format("{}: {}", name, option));
  BodyPoses result;
  result.body.names = wanted;
  result.body.shape_m = shape.shape_m();
  result.step_m = step_of_points(own_m.size(), own_m[0].cols(),
                                 [&](std::size_t k) -> const PointColumns& { return own_m[k]; });
  std::vector<double> residuals_m;
  for (const PointColumns& points_m : own_m) {
    BodyFit fit = shape.fit(points_m);
    if (fit.growth > kMostGrowth) fit = BodyFit();
    if (fit.is_fitted) {
      residuals_m.push_back(fit.residual_rms_m);
    } else {
      ++result.too_few;
    }
    result.fits.push_back(fit);
  }
  refuse_if_short(residuals_m.size(), points.counts, name);
  const double tolerance_m = residual_tolerance_m(residuals_m);
  result.body.residual_m = usual_residual_m(residuals_m);
  result.problem = rigidity_problem(result, points.time_s, body);
  if (!result.problem.empty()) return result;  // then nothing of it is trusted
  for (BodyFit& fit : result.fits) {
    if (!fit.is_fitted || fit.residual_rms_m <= tolerance_m) continue;
    fit.is_fitted = false;
    ++result.not_rigid;
  }
  return result;
}

PoseTrack read_bodies(NamedPointsRecording& recording, const std::string& name,
                      const BodyChoice& bodies) {
  const NamedPoints points = read_named_points(recording, name);
  PoseTrack track;
  track.info = points.info;
  track.counts = points.counts;
  track.has_rotation = true;
  const std::vector<std::string> jaw_names =
      bodies.jaw.empty() ? others(points.names, bodies.head) : bodies.jaw;
  for (const std::string& point : bodies.head) {
    if (std::find(jaw_names.begin(), jaw_names.end(), point) == jaw_names.end()) continue;
    throw InputError("--head", fmt::format("the point {} is also one of --jaw", point),
                     "give each point to one body");
  }
  const BodyPoses jaw = fit_body(points, jaw_names, "jaw", "--jaw", name);
  if (!bodies.is_given() && !jaw.problem.empty()) {
    throw InputError(
        name,
        fmt::format("its {} points, {}, are not one rigid body", jaw_names.size(),
                    list_of_points(jaw_names)),
        "name the jaw's with --jaw A,B,C, and the head's with --head D,E,F; or follow one point "
        "with --marker NAME");
  }
  track.jaw = jaw.body;
  track.step_m = jaw.step_m;
  track.body_problem = jaw.problem;
  describe("jaw", jaw, track);
  BodyPoses head;
  if (!bodies.head.empty()) {
    head = fit_body(points, bodies.head, "head", "--head", name);
    track.head = head.body;
    track.step_m = std::hypot(jaw.step_m, head.step_m);
    if (track.body_problem.empty()) track.body_problem = head.problem;
    describe("head", head, track);
  }
  std::vector<double> growth;
  for (std::size_t k = 0; k < points.time_s.size(); ++k) {
    const BodyFit& of_jaw = jaw.fits[k];
    const BodyFit* const of_head = head.fits.empty() ? nullptr : &head.fits[k];
    if (!of_jaw.is_fitted || (of_head != nullptr && !of_head->is_fitted)) {
      // Only what was fitted, and did not fit, has a residual.
      const bool misfits =
          (!of_jaw.is_fitted && of_jaw.residual_rms_m > 0) ||
          (of_head != nullptr && !of_head->is_fitted && of_head->residual_rms_m > 0);
      ++(misfits ? track.counts.not_rigid : track.counts.missing);
      continue;
    }
    track.time_s.push_back(points.time_s[k]);
    track.pose.push_back(of_jaw.pose);
    growth.push_back(std::max(of_jaw.growth, of_head != nullptr ? of_head->growth : 1));
    if (of_head != nullptr) track.head_pose.push_back(of_head->pose);
  }
  refuse_if_short(track.pose.size(), track.counts, name);
  track.noise_growth = greatest_mean(track.time_s, growth);
  if (!track.head_pose.empty()) {
    // What jumps or freezes shows in each body by itself.
    keep_usable(track);
    std::swap(track.pose, track.head_pose);
    keep_usable(track);
    std::swap(track.pose, track.head_pose);
    refuse_if_short(track.pose.size(), track.counts, name);
    track.head_at = track.head_pose.front();
    for (std::size_t k = 0; k < track.pose.size(); ++k) {
      track.pose[k] = track.head_at * track.head_pose[k].inverse(Eigen::Isometry) * track.pose[k];
    }
  }
  keep_usable(track);
  refuse_if_short(track.pose.size(), track.counts, name);
  return track;
}

bool is_read_as_bodies(const Recording& recording, const BodyChoice& bodies) {
  const auto* const named = dynamic_cast<const NamedPointsRecording*>(&recording);
  return bodies.is_given() || (named != nullptr && named->names().size() > 3);
}

PoseTrack read_track(Recording& recording, const std::string& name, const BodyChoice& bodies) {
  if (!is_read_as_bodies(recording, bodies)) return read_poses(recording, name);
  auto* const named = dynamic_cast<NamedPointsRecording*>(&recording);
  if (named == nullptr || named->names().empty()) {
    throw InputError(name, "its points have no names",
                     "leave out --jaw and --head, which name points of a CSV file");
  }
  return read_bodies(*named, name, bodies);
}

void refer_to_head(PoseTrack& track, const Isometry3d& head_at) {
  const Isometry3d change = head_at * track.head_at.inverse(Eigen::Isometry);
  for (Isometry3d& pose : track.pose) pose = change * pose;
  track.head_at = head_at;
}

}  // namespace condyle::host
