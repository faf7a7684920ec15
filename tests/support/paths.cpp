// SPDX-License-Identifier: Apache-2.0
#include "support/paths.h"

#include <filesystem>

namespace condyle::testing_support {

std::string source_path(const std::string& below) {
  return CONDYLE_SOURCE_DIR + below;
}

std::string program_path(const std::string& name) {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / name;
}

}  // namespace condyle::testing_support
