// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace condyle::host {

/// Something the user gave cannot be used: says where, what is wrong and how to mend it. The
/// command prints it and exits with 2.
class InputError : public std::runtime_error {
 public:
  /// `where`: "FILE", "FILE:LINE" or "FILE:LINE: column NAME".
  InputError(const std::string& where, const std::string& problem, const std::string& mend)
      : std::runtime_error(where + ": " + problem + (mend.empty() ? "" : "; " + mend)) {}
};

}  // namespace condyle::host
