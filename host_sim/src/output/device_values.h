// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "output/output_file.h"

namespace condyle::host {

/// Writes what the devices of a session log, or the one of a capture, measured beside position, a
/// CSV file for each device that did: `folder`/NAME.csv with time_s (host time, as the estimates'),
/// drive_N and the auxiliary fields; empty if a value was not measured. `profile`: a file to be
/// used for the facebow instead of the log's own; may be empty. Gives the files, closed and not
/// committed, in `files`, and what the user should know of each device's reports.
std::vector<std::string> write_device_values(const std::string& recording,
                                             const std::string& profile, const std::string& folder,
                                             std::vector<std::unique_ptr<OutputFile>>& files);

}  // namespace condyle::host
