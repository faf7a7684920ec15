// SPDX-License-Identifier: Apache-2.0
// The options that several commands share. Each function gives `command` options that fill its
// second argument, which must outlive them.
#pragma once

#include "estimation/drive_statement.h"
#include "estimation/estimator_choice.h"
#include "estimation/learned_file.h"
#include "hosted/estimates/followed_cycles.h"
#include "hosted/estimates/pose_choice.h"
#include "options/command_line.h"
#include "recordings/recording_choice.h"

namespace condyle::host {

/// What --profile means in every command.
inline constexpr const char* kProfileMeaning =
    "TOML file that describes the device and the meaning of its reports";

/// Whether a command can follow points of the jaw in addition to those of the instrument.
enum class JawPoints { no, yes };

/// --point, --axis and --jaw-point-mm.
void add_followed_options(CommandLine command, FollowedChoice& choice,
                          JawPoints jaw_points = JawPoints::yes);

/// Whether a command takes the frames per second of a file, or has a --rate-Hz of its own.
enum class FrameRate { no, yes };

/// --ignore-column, --marker, --columns, --rate-Hz, --profile, --unit and --movement.
void add_reading_options(CommandLine command, RecordingOptions& reading,
                         FrameRate frame_rate = FrameRate::yes);

/// --faults.
void add_faults_option(CommandLine command, RecordingOptions& reading);

/// The options of the three functions above.
void add_recording_options(CommandLine command, RecordingChoice& choice,
                           JawPoints jaw_points = JawPoints::yes);

/// --learned and --learned-out.
void add_learned_options(CommandLine command, LearnedFiles& files);

/// --estimator, --lag and --parameters.
void add_estimator_options(CommandLine command, EstimatorChoice& choice);

/// What `add_pose_options` fills.
struct PoseOptions {
  std::string file;  ///< empty: the pose is not estimated
  std::vector<std::string> point_words;
  std::string twist_axis = "x";

  /// The choice. Throws InputError for points that cannot be.
  PoseChoice choice() const;
};

/// --pose, --pose-point and --twist-axis.
void add_pose_options(CommandLine command, PoseOptions& options);

/// What `add_cycle_options` fills.
struct CycleOptions {
  std::string file;  ///< empty: cycles are not found
  std::string closing = "positive";

  /// The choice for the axis that is followed.
  CycleChoice choice(Axis followed) const { return {followed, closing == "positive"}; }
};

/// --cycles and --closing.
void add_cycle_options(CommandLine command, CycleOptions& options);

/// --drive-missing and the other properties of a measured drive.
void add_drive_options(CommandLine command, DriveStatement& drive);

}  // namespace condyle::host
