// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "condyle/hal/report/report_layout.h"

namespace condyle::hal {

/// The cyclic redundancy check of `bytes` (all of them) by the model's parameters.
std::uint32_t checksum_of(const Checksum& model, std::span<const std::uint8_t> bytes);

}  // namespace condyle::hal
