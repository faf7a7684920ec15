// SPDX-License-Identifier: Apache-2.0
// What is wrong with a layout, in words. Library-private: find_problem and refusal_words call it.
#pragma once

#include <cstddef>
#include <string>

#include "condyle/hal/hid/profile_check.h"

namespace condyle::hal {

/// Name of a part: "condyle's x1", "the sequence". Where `profile` has no such part: of its kind.
std::string name_of(const DeviceProfile& profile, ProfilePart part, std::size_t index);

/// `problem`, which find_layout_problem found in the layout of `profile`, in words.
ProfileProblem words_of(const LayoutProblem& problem, const DeviceProfile& profile,
                        LayoutState state);

}  // namespace condyle::hal
