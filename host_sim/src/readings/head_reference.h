// SPDX-License-Identifier: Apache-2.0
// Where landmarks hold: with the bodies where the landmarks' file states their points, otherwise
// with the head where it is in the reference position.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "readings/body_tracks.h"
#include "readings/landmarks.h"
#include "readings/pose_track.h"
#include "readings/sample_run.h"

namespace condyle::host {

/// Refers the jaw to the head where the landmarks of the file `path` state it, if they do and the
/// head is tracked: true. Widens the landmarks by what the head's points misfit. Throws an
/// InputError if they are not those of the tracked head.
bool place_stated_head(PoseTrack& track, std::optional<Landmarks>& landmarks,
                       const std::string& path, std::vector<std::string>& notes);

/// Widens `landmarks` by the motion of the head during the reference `rest`, in which they were
/// taken at an instant that is not known. Throws an InputError that names `recording` if it moves
/// too far.
void widen_by_head_motion(const PoseTrack& track, SampleRun rest, Landmarks& landmarks,
                          const std::string& recording, std::vector<std::string>& notes);

/// Throws an InputError that names `path` if the landmarks state points of the jaw, and these lie
/// elsewhere in the reference `rest`.
void check_stated_jaw(const PoseTrack& track, SampleRun rest, const Landmarks& landmarks,
                      const std::string& path);

}  // namespace condyle::host
