// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "condyle/hal/log/mcap_format.h"

namespace condyle::hal {

/// True for an opcode of the specification.
inline bool is_known(McapOpcode opcode) {
  return opcode >= McapOpcode::header && opcode <= McapOpcode::data_end;
}

/// The opcode as it appears in messages.
inline std::string number_text(McapOpcode opcode) {
  return std::to_string(static_cast<int>(opcode));
}

}  // namespace condyle::hal
