// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "condyle/estimator/sample.h"

namespace condyle::box {

/// Sends `state`, such as "READY=1", to the service manager (sd_notify(3)); does nothing if there
/// is none.
void notify_service_manager(const std::string& state);

/// Longest time between two "WATCHDOG=1" (sd_watchdog_enabled(3)); 0: no watchdog.
TimeNs watchdog_period_ns();

}  // namespace condyle::box
