// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fake/fake_setup.h"
#include "options/command_line.h"

namespace condyle::host::fake {

/// Adds the command-line options of the device that all transports share; parsing fills `options`,
/// which must outlive the parsing.
void add_arguments(CommandLine command, FakeOptions& options);

}  // namespace condyle::host::fake
