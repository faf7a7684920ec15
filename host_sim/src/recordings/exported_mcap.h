// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "recordings/named_points.h"

namespace condyle::host {

/// The format of such a file; its positions are in metres.
inline constexpr std::string_view kExportedMcap = "MCAP exported by condyle";

/// True if the MCAP file at `path` was written by export, not by record.
bool is_exported_mcap(const std::string& path);

/// The measurements in such a file; without names if they are of one axis or poses.
std::unique_ptr<NamedPointsRecording> open_exported_mcap(const std::string& path);

}  // namespace condyle::host
