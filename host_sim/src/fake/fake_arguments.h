// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "command_line.h"
#include "fake/fake_setup.h"

namespace condyle::host::fake {

/// Adds the command-line options of the device that all transports share; parsing fills `options`,
/// which must live until then.
void add_arguments(CommandLine command, FakeOptions& options);

}  // namespace condyle::host::fake
