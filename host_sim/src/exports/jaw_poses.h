// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exports/export_data.h"
#include "exports/mcap_messages.h"

namespace condyle::host {

/// Poses of the jaw in the instrument's frame.
struct JawPoses {
  Provenance provenance = Provenance::measured;
  std::string assumption;  ///< of derived poses
  std::vector<std::optional<ExportPose>> of_sample;
};

/// The measured poses; or, if the recording has exactly three points, the poses of the rigid body
/// that they form, in the jaw frame of rigid_body.h. A sample whose points do not fit the body has
/// none. Empty if the recording has neither, or if its points span no triangle.
std::optional<JawPoses> jaw_poses(const ExportData& data);

}  // namespace condyle::host
