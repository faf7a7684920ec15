// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "options/command_text.h"

namespace condyle::host {

/// Writes what packages install: a manual page of `program` and of each of its commands
/// (NAME-COMMAND.1), and the completion for bash (NAME.bash), into `folder`.
void write_manual(const CommandText& program, const std::string& version,
                  const std::string& folder);

}  // namespace condyle::host
