// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace condyle::host {

/// Samples from `begin` to `end` (without).
struct SampleRun {
  std::size_t begin, end;
};

}  // namespace condyle::host
