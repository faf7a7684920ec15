// SPDX-License-Identifier: Apache-2.0
// Paths of files and programs for the tests. Only one object file contains the folders, so that the
// others compile to the same bytes in every folder.
#pragma once

#include <string>

namespace condyle::testing_support {

/// The file `below` ("/folder/name") the project's root.
std::string source_path(const std::string& below);

/// The program `name` of this build, in the folder of the running one. The environment variable
/// CONDYLE_COMMAND names another build's `condyle`.
std::string program_path(const std::string& name);

}  // namespace condyle::testing_support
