// SPDX-License-Identifier: Apache-2.0
// The subcommands of condyle. Each adds itself to the command line; the returned function runs it
// and gives the exit code.
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace condyle::host {

/// Done.
inline constexpr int kExitOk = 0;
/// The command line or an input cannot be used.
inline constexpr int kExitBadInput = 2;
/// Stopped by the user.
inline constexpr int kExitInterrupted = 130;

using Command = std::function<int()>;

/// `condyle replay`
Command add_replay(CLI::App& app);
/// `condyle observability`
Command add_observability(CLI::App& app);

/// True once the user asked the program to stop (SIGINT, SIGTERM).
bool stop_requested();

}  // namespace condyle::host
