// SPDX-License-Identifier: Apache-2.0
// A decoded report descriptor as text and as JSON.
#pragma once

#include <string>

#include "condyle/hal/hid/report_descriptor.h"

namespace condyle::host {

/// "X (0001:0030)"; only the numbers if the usage has no name here.
std::string usage_text(const hal::UsageRange& range);

/// As text, one line for each field; ends with a line feed.
std::string descriptor_text(const hal::ReportDescriptor& descriptor);

/// As a JSON object; hal/README.md describes it. Ends with a line feed.
std::string descriptor_json(const hal::ReportDescriptor& descriptor);

}  // namespace condyle::host
