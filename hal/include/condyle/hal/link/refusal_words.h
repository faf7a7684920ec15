// SPDX-License-Identifier: Apache-2.0
// Why a target does not take a message, in words.
#pragma once

#include <string>

#include "condyle/hal/link/link_messages.h"

namespace condyle::hal {

/// A refusal for the user.
struct RefusalWords {
  std::string reason;  ///< "the layout: condyle's x1, scale, is not a finite number"
  std::string mend;
};

/// The words of `refused`. `layout` and `start` are those that were sent to the target last: what
/// it refuses of them is named as device profiles, parameter files and options name it.
RefusalWords words_of(const RefusedMessage& refused, const LayoutMessage& layout,
                      const StartMessage& start);

}  // namespace condyle::hal
