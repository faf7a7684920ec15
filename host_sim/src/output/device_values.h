// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "output/output_file.h"

namespace condyle::host {

/// Writes the values other than positions of the devices of a session log or capture, one CSV file
/// for each device with such values: `folder`/NAME.csv with time_s (host time, as the estimates'),
/// drive_N and the auxiliary fields; empty if a value was not measured. `profile`: a profile file
/// that replaces the log's own for the facebow; may be empty. Appends the files to `files`, closed
/// but not committed, and returns notes on each device's reports for the user.
std::vector<std::string> write_device_values(const std::string& recording,
                                             const std::string& profile, const std::string& folder,
                                             std::vector<std::unique_ptr<OutputFile>>& files);

}  // namespace condyle::host
