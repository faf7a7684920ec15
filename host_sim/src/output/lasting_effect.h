// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace condyle::host {

/// True once the command has an effect that lasts: a file under its final name, a recording that
/// has begun, a request to a box. From then on, an error is shown even if the user has stopped the
/// command.
inline std::atomic<bool> has_lasting_effect = false;

}  // namespace condyle::host
