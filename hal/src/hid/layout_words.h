// SPDX-License-Identifier: Apache-2.0
// What is wrong with a layout, in words. Library-private: find_problem calls it.
#pragma once

#include "condyle/hal/hid/profile_check.h"

namespace condyle::hal {

/// `problem`, which find_layout_problem found in the layout of `profile`, in words.
ProfileProblem words_of(const LayoutProblem& problem, const DeviceProfile& profile,
                        LayoutState state);

}  // namespace condyle::hal
