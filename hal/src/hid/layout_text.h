// SPDX-License-Identifier: Apache-2.0
// Puts the problems of a layout into words. Library-private: find_problem calls it.
#pragma once

#include "condyle/hal/hid/profile_check.h"

namespace condyle::hal {

/// The words for `problem`, which find_layout_problem found in the layout of `profile`.
ProfileProblem words_of(const LayoutProblem& problem, const DeviceProfile& profile,
                        LayoutState state);

}  // namespace condyle::hal
