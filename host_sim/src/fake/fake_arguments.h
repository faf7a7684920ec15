// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fake/fake_setup.h"

namespace CLI {
class App;
}

namespace condyle::host::fake {

/// Adds the command-line options of the device that all transports share; parsing fills `options`,
/// which must live until then.
void add_arguments(CLI::App& command, FakeOptions& options);

}  // namespace condyle::host::fake
