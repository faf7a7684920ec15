// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>

namespace condyle::hal {

/// To be held wherever hidapi is initialised, lists devices or opens one: hidapi 0.13 keeps one
/// error text for the whole process there, which it frees and replaces. Reading needs no lock.
inline std::mutex& hidapi_mutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace condyle::hal
