// SPDX-License-Identifier: Apache-2.0
#include "support/paths.h"

#include <cstdlib>
#include <filesystem>

namespace condyle::testing_support {

std::string source_path(const std::string& below) {
  return CONDYLE_SOURCE_DIR + below;
}

std::string program_path(const std::string& name) {
  const char* command = std::getenv("CONDYLE_COMMAND");
  if (command != nullptr && name == "condyle") return command;
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / name;
}

}  // namespace condyle::testing_support
