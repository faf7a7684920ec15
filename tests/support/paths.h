// SPDX-License-Identifier: Apache-2.0
// Where the tests find files and programs. One object file knows the folders, so that the others
// compile alike wherever the project lies.
#pragma once

#include <string>

namespace condyle::testing_support {

/// The file `below` ("/folder/name") the project's root.
std::string source_path(const std::string& below);

/// The program `name` of this build: it lies beside the running one.
std::string program_path(const std::string& name);

}  // namespace condyle::testing_support
