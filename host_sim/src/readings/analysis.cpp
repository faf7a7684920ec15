// SPDX-License-Identifier: Apache-2.0
#include "readings/analysis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "hosted/files/input_error.h"
#include "readings/analysis_stop.h"
#include "readings/head_reference.h"
#include "readings/number_step.h"
#include "readings/strokes.h"
#include "readings/task_readings.h"
#include "readings/uncertainty.h"
#include "readings/whole_path.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180, kMillimetre = 1e-3;
// No jaw moves that far without turning more than that.
constexpr double kFarWithoutTurn_m = 15e-3, kLeastTurn_rad = 2 * kDegree;
constexpr double kLeastReference_s = 0.1;
constexpr double kMostRotation_deg = 70, kMostResidual_m = 0.15e-3;
constexpr double kMostBeyond_m = 1e-3;           // of closing, beyond the reference position
constexpr double kMostReferenceMotion_m = 1e-3;  // during a stated reference
constexpr double kSmoothed = 1.5;
constexpr double kNearRest_m = 1.5e-3, kNearRest_rad = 1.5 * kDegree;

// Direction of closing in the instrument's frame.
Vector3d up_of(const std::optional<Landmarks>& landmarks, MovingBody moving) {
  if (!landmarks) return Vector3d::Zero();
  const Vector3d up = head_frame(*landmarks).linear().col(2);
  return moving == MovingBody::upper ? Vector3d(-up) : up;
}

SampleRun reference_of(const PoseTrack& track, const AnalysisChoice& choice,
                       const std::optional<Landmarks>& landmarks, const std::string& recording,
                       Analysis& analysis) {
  SampleRun run{0, 0};
  if (choice.reference_s) {
    const auto [begin_s, end_s] = *choice.reference_s;
    const auto& time_s = track.time_s;
    run.begin = static_cast<std::size_t>(
        std::lower_bound(time_s.begin(), time_s.end(), begin_s - 1e-9) - time_s.begin());
    run.end = static_cast<std::size_t>(
        std::upper_bound(time_s.begin(), time_s.end(), end_s + 1e-9) - time_s.begin());
    if (run.end < run.begin + 2) {
      throw InputError(recording,
                       fmt::format("--reference-s {:g} {:g}: it has {} usable samples there",
                                   begin_s, end_s, run.end > run.begin ? run.end - run.begin : 0),
                       fmt::format("give an interval of rest between {:g} and {:g} s",
                                   time_s.front(), time_s.back()));
    }
  } else if (const auto rest = find_rest(track, up_of(landmarks, choice.moving))) {
    run = *rest;
    analysis.is_reference_found = true;
  } else {
    throw InputError(recording, "no rest of 0.3 s was found for the reference position",
                     "state one with --reference-s BEGIN END");
  }
  if (choice.reference_s) {
    // Means of a tenth of the samples each, so that noise does not look like motion.
    const std::size_t count = run.end - run.begin, block = std::max<std::size_t>(count / 10, 1);
    std::vector<Vector3d> means_m;
    for (std::size_t k = run.begin; k + block <= run.end; k += block) {
      Vector3d sum_m = Vector3d::Zero();
      for (std::size_t i = k; i < k + block; ++i) sum_m += track.pose[i].translation();
      means_m.emplace_back(sum_m / static_cast<double>(block));
    }
    std::vector<double> distances_m;
    for (const Vector3d& mean_m : means_m) {
      distances_m.push_back((mean_m - means_m.front()).norm());
    }
    const double usual_m = upper_median(std::move(distances_m));
    if (usual_m > kMostReferenceMotion_m) {
      throw InputError(
          recording, fmt::format("the jaw moves by {:.1f} mm during --reference-s", usual_m * 1e3),
          "give an interval in which it rests");
    }
  }
  analysis.reference_begin_s = track.time_s[run.begin];
  analysis.reference_end_s = track.time_s[run.end - 1];
  return run;
}

// The reference position, with the jaw as seen with the head where it is there.
SampleRun reference_with_head(PoseTrack& track, const AnalysisChoice& choice,
                              std::optional<Landmarks>& landmarks, const std::string& recording,
                              Analysis& analysis) {
  constexpr int kMostRounds = 5;
  const bool is_placed = place_stated_head(track, landmarks, choice.landmarks, analysis.notes);
  SampleRun rest = reference_of(track, choice, landmarks, recording, analysis);
  if (track.head_pose.empty()) return rest;
  // Which rest is the most closed depends on where the head was.
  for (int round = 0; !is_placed && round < kMostRounds; ++round) {
    refer_to_head(track, mean_pose(track.head_pose, rest.begin, rest.end));
    const SampleRun last = rest;
    rest = reference_of(track, choice, landmarks, recording, analysis);
    if (rest.begin == last.begin && rest.end == last.end) break;
  }
  if (!is_placed && landmarks) {
    widen_by_head_motion(track, rest, *landmarks, recording, analysis.notes);
  }
  return rest;
}

// Turns `motion` and the landmarks into the head frame, where all that follows is the same whatever
// the frame of the instrument.
Landmarks in_head_frame(Landmarks landmarks, ReferredMotion& motion) {
  const Eigen::Isometry3d into_head = head_frame(landmarks).inverse(Eigen::Isometry);
  for (Vector3d& point : landmarks.point_m) point = into_head * point;
  motion.middle_m = into_head * motion.middle_m;
  for (Vector6& place : motion.motion) {
    place.head<3>() = into_head.linear() * place.head<3>();
    place.tail<3>() = into_head.linear() * place.tail<3>();
  }
  return landmarks;
}

// How far other rests near the reference position lie from it: mean of their squares and products.
// A fork that slips, or a drift, shows there.
Matrix6 spread_of_rests(const PoseTrack& track, const ReferredMotion& motion) {
  Matrix6 spread = Matrix6::Zero();
  double count = 0;
  for (const SampleRun& run : find_rests(track)) {
    Vector6 mean = Vector6::Zero();
    for (std::size_t k = run.begin; k < run.end; ++k) mean += motion.motion[k];
    mean /= static_cast<double>(run.end - run.begin);
    if (mean.head<3>().norm() > kNearRest_m || mean.tail<3>().norm() > kNearRest_rad) continue;
    spread += mean * mean.transpose();
    ++count;
  }
  return count > 1 ? Matrix6(spread / (count - 1)) : spread;
}

// From the reference position, or the longest rest if that is too short.
PoseNoise noise_at_rest(const PoseTrack& track, const ReferredMotion& motion, SampleRun reference,
                        const Matrix6& least, Analysis& analysis) {
  PoseNoise noise = noise_of(motion, reference.begin, reference.end, least);
  if (noise.is_checked_at_rest || !noise.is_known) return noise;
  SampleRun longest = reference;
  for (const SampleRun& run : find_rests(track)) {
    if (run.end - run.begin > longest.end - longest.begin) longest = run;
  }
  noise = noise_of(motion, longest.begin, longest.end, least);
  if (!noise.is_checked_at_rest) {
    analysis.notes.push_back(
        "no rest is long enough to see noise that neighbouring samples share: intervals may be too "
        "narrow; record a rest of 3 s");
  }
  return noise;
}

ReadingGeometry geometry_without_landmarks(const PoseTrack& track, const ReferredMotion& motion,
                                           SampleRun reference) {
  ReadingGeometry geometry;
  geometry.middle_m = geometry.incisor_m = motion.middle_m;
  geometry.condyle_m = {motion.middle_m, motion.middle_m};
  if (track.jaw.shape_m.cols() > 0) {
    geometry.incisor_m += track.pose[reference.begin].linear() * track.jaw.shape_m.col(0);
  }
  return geometry;
}

// Why readings that need rotation are withheld; empty: they are not.
std::string rotation_problem(const PoseTrack& track, const Analysis& analysis) {
  if (!track.has_rotation) return "the recording has one point, which shows no rotation";
  const double sd_deg = analysis.noise.rotation_sd_rad() / kDegree;
  if (analysis.largest_rotation_deg < 3 * sd_deg) {
    return fmt::format("the jaw turns by {:.2f} deg, its noise has {:.2f} deg (sd)",
                       analysis.largest_rotation_deg, sd_deg);
  }
  return "";
}

// Why the points are no jaw's; empty: they may be.
std::string body_problem(const PoseTrack& track, const Analysis& analysis) {
  if (analysis.largest_rotation_deg > kMostRotation_deg) {
    return fmt::format("the points turn by {:.0f} deg, which no jaw does; were two exchanged?",
                       analysis.largest_rotation_deg);
  }
  if (!track.jaw.names.empty()) return track.body_problem;
  const double noise_m = std::sqrt(analysis.noise.covariance.topLeftCorner<3, 3>().trace() / 3);
  if (track.jaw.residual_m > std::max(kMostResidual_m, 6 * noise_m)) {
    return fmt::format("its three points do not keep their distances (they misfit by {:.2f} mm)",
                       track.jaw.residual_m * 1e3);
  }
  return "";
}

// Landmarks and recording must both know the head, or neither.
std::string landmark_assumption(const PoseTrack& track, const std::optional<Landmarks>& landmarks) {
  if (!landmarks || landmarks->head.names.empty() == track.head_pose.empty()) return "";
  return track.head_pose.empty()
             ? "the head is assumed not to have moved since the landmarks were taken"
             : "the landmarks are assumed to hold with the head where it is in the reference "
               "position";
}

// What a found reference position assumes; empty: nothing contradicts it. The jaw closes no further
// than to it.
std::string reference_assumption(Analysis& analysis) {
  if (!analysis.is_reference_found || !analysis.has_landmarks) return "";
  std::size_t beyond = 0;
  double highest_m = 0;
  for (const auto& point : analysis.path.incisor_m) {
    if (point.z() < kMostBeyond_m) continue;
    ++beyond;
    highest_m = std::max(highest_m, point.z());
  }
  if (beyond < 5) return "";
  const std::string text = fmt::format(
      "the jaw closes {:.1f} mm beyond the reference position that was found; state it with "
      "--reference-s",
      highest_m * 1e3);
  analysis.notes.push_back(text);
  return text;
}

Analysis analyse_recording(Recording& recording, const std::string& name,
                           const std::optional<Landmarks>& given, const AnalysisChoice& choice,
                           const std::function<bool()>& should_stop) {
  Analysis analysis;
  analysis.recording = name;
  PoseTrack track = read_track(recording, name, choice.bodies);
  stop_if_asked(should_stop);
  std::optional<Landmarks> stated = given;
  analysis.info = track.info;
  analysis.counts = track.counts;
  analysis.events = track.events;
  analysis.notes = track.notes;
  analysis.has_landmarks = stated.has_value();
  const double end_s = track.time_s.back();
  analysis.duration_s = end_s - track.time_s.front();
  analysis.rate_Hz = static_cast<double>(track.time_s.size() - 1) / analysis.duration_s;
  const SampleRun rest = reference_with_head(track, choice, stated, name, analysis);
  if (analysis.reference_end_s - analysis.reference_begin_s < kLeastReference_s) {
    analysis.notes.push_back("the reference position rests on less than 0.1 s");
  }
  ReferredMotion motion = motion_from(track, rest.begin, rest.end, choice.moving);
  std::optional<Landmarks> landmarks;
  if (stated) {
    check_near(*stated, motion.middle_m, choice.landmarks);
    check_stated_jaw(track, rest, *stated, choice.landmarks);
    landmarks = in_head_frame(*stated, motion);
  }
  const Matrix6 steps = covariance_of_steps(track, rest.begin);
  analysis.noise = noise_at_rest(track, motion, rest, steps, analysis);
  grow(analysis.noise, track.noise_growth);
  const ReadingGeometry geometry = landmarks ? geometry_of(*landmarks, motion.middle_m)
                                             : geometry_without_landmarks(track, motion, rest);
  WholePath whole = whole_path(motion, geometry, analysis.noise.covariance);
  analysis.path = std::move(whole.path);
  analysis.incisor_sd_m = std::move(whole.incisor_sd_m);
  analysis.largest_rotation_deg = whole.largest_rotation_rad / kDegree;
  analysis.largest_displacement_mm = whole.largest_displacement_m / kMillimetre;
  stop_if_asked(should_stop);

  TaskContext context;
  context.should_stop = should_stop;
  context.motion = &motion;
  context.noise = &analysis.noise;
  context.has_landmarks = analysis.has_landmarks;
  if (landmarks && landmarks->condyle_kind == "arbitrary") {
    context.condyle_assumption = "the condylar points are arbitrary, not measured";
  }
  context.landmark_assumption = landmark_assumption(track, stated);
  context.errors = shared_errors(
      landmarks ? &*landmarks : nullptr, geometry,
      covariance_of_mean(analysis.noise, rest.end - rest.begin, 1 / analysis.rate_Hz) +
          spread_of_rests(track, motion) + left_in_mean(steps, analysis.noise));
  context.rotation_problem = rotation_problem(track, analysis);
  if (track.has_rotation && analysis.largest_displacement_mm * kMillimetre > kFarWithoutTurn_m &&
      analysis.largest_rotation_deg * kDegree < kLeastTurn_rad) {
    analysis.unusable = fmt::format(
        "the points move by {:.0f} mm and turn by {:.1f} deg, which no jaw does: the recording has "
        "lost its rotation",
        analysis.largest_displacement_mm, analysis.largest_rotation_deg);
  }
  if (!analysis.noise.is_known) {
    analysis.unusable = "too few samples lie within 0.1 s of each other to know their noise";
  }
  if (analysis.unusable.empty()) analysis.unusable = body_problem(track, analysis);
  context.unusable = analysis.unusable;
  context.reference_assumption = reference_assumption(analysis);
  if (analysis.noise.coloured > kSmoothed) {
    context.smoothing_assumption =
        "the instrument smooths its positions; fast movements may be larger";
  }

  analysis.tasks = choice.tasks;
  if (analysis.tasks.empty() && track.info.is_of_device) {
    analysis.tasks = marked_tasks(name, end_s);
  }
  if (analysis.tasks.empty()) analysis.tasks = found_tasks(analysis.path, context);
  for (const Task& task : analysis.tasks) {
    if (task.begin_s > end_s || task.end_s < track.time_s.front()) {
      throw InputError(name,
                       fmt::format("task {} from {:g} to {:g} s lies outside the recording",
                                   name_of(task.kind), task.begin_s, task.end_s),
                       fmt::format("it lasts from {:g} to {:g} s", track.time_s.front(), end_s));
    }
  }
  if (analysis.tasks.empty()) {
    analysis.tasks.push_back({TaskKind::whole, track.time_s.front(), end_s, true});
    analysis.notes.push_back(
        analysis.has_landmarks
            ? "no task was found; state them with --task NAME BEGIN END"
            : "without landmarks no task is found; state them with --task NAME BEGIN END");
  }
  read_tasks_of(analysis, context);
  return analysis;
}

}  // namespace

Analysis analyse_until(const std::string& source, const AnalysisChoice& choice,
                       const std::function<bool()>& should_stop) {
  std::optional<Landmarks> landmarks;
  if (!choice.landmarks.empty()) landmarks = load_landmarks(choice.landmarks);
  RecordingOptions reading = choice.reading;
  reading.faults = FaultPolicy::event;  // missing rows are counted
  return analyse_recording(*open_with_all_points(source, reading), source, landmarks, choice,
                           should_stop);
}

Analysis analyse(const std::string& source, const AnalysisChoice& choice) {
  return analyse_until(source, choice, {});
}

Analysis analyse(Recording& recording, const std::string& name,
                 const std::optional<Landmarks>& given, const AnalysisChoice& choice) {
  return analyse_recording(recording, name, given, choice, {});
}

}  // namespace condyle::host
