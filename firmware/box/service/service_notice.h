// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "condyle/estimator/sample.h"

namespace condyle::box {

/// Tells the service manager `state`, such as "READY=1" (sd_notify(3)); nothing where there is
/// none.
void notify_service_manager(const std::string& state);

/// How often it wants to hear "WATCHDOG=1", at least; 0: never (sd_watchdog_enabled(3)).
TimeNs watchdog_period_ns();

}  // namespace condyle::box
