// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "box/configuration.h"
#include "condyle/hal/clock.h"

namespace condyle::box {

/// Runs the box's real-time thread on a synthetic facebow for `duration_s`, or until `should_stop`,
/// with a reader that empties its ring. Returns as text how late this machine woke the thread and
/// how long it took from a report to its estimate, each with a histogram. Does not use a node.
std::string test_latency(const Configuration& configuration, double duration_s, hal::Clock& clock,
                         const std::function<bool()>& should_stop);

}  // namespace condyle::box
