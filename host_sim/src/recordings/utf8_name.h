// SPDX-License-Identifier: Apache-2.0
// Names in files of spreadsheets and programs that write Latin-1.
#pragma once

#include <string>

namespace condyle::host {

/// `name` as UTF-8, which it is already or as Latin-1 (the letters of Windows-1252 too); unchanged
/// if it is neither.
std::string utf8_name(std::string name);

}  // namespace condyle::host
