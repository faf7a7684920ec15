// SPDX-License-Identifier: Apache-2.0
// An identified head motion as text, JSON and figure.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "output/output_file.h"
#include "protocols/head_motion/head_motion_recording.h"

namespace condyle::host {

/// Its values with intervals and provenance, or why there are none.
std::string head_motion_text(const IdentifiedHeadMotion& motion);
/// The same as JSON; null: not known.
std::string head_motion_json(const IdentifiedHeadMotion& motion);

/// Draws kv/m and ks/m with their 95 % intervals over the recorded time, as head_motion.svg and
/// head_motion.png. The files are closed but not committed.
std::vector<std::unique_ptr<OutputFile>> draw_head_motion(const std::string& directory,
                                                          const IdentifiedHeadMotion& motion);

}  // namespace condyle::host
