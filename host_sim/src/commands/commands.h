// SPDX-License-Identifier: Apache-2.0
// The subcommands of condyle. Each adds itself to the command line; the returned function runs it
// and gives the exit code.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "options/command_line.h"

namespace condyle::host {

/// Done.
inline constexpr int kExitOk = 0;
/// The command line or an input cannot be used.
inline constexpr int kExitBadInput = 2;
/// The judged object is not as required; the message states where and why.
inline constexpr int kExitRefused = 3;
/// Stopped by the user.
inline constexpr int kExitInterrupted = 130;
/// A defect of condyle.
inline constexpr int kExitInternal = 70;

using Command = std::function<int()>;
/// Names of subcommands, and what they do.
using Commands = std::vector<std::pair<const char*, Command>>;

/// Adds the subcommands of this program, in the order of its help.
Commands add_commands(CommandLine line);
/// Throws InputError if `words` begin with a subcommand that other programs have, and `commands`
/// lack. The whole condyle does so for its help, too.
void refuse_absent(const Commands& commands, const std::vector<std::string>& words);

/// `condyle analyse`
Command add_analyse(CommandLine app);
/// `condyle report`, if it was built
Command add_report(CommandLine app);
/// `condyle info`
Command add_info(CommandLine app);
/// `condyle export`
Command add_export(CommandLine app);
/// `condyle landmarks`
Command add_landmarks(CommandLine app);
/// `condyle replay`
Command add_replay(CommandLine app);
/// `condyle simulate`
Command add_simulate(CommandLine app);
/// `condyle evaluate`
Command add_evaluate(CommandLine app);
Command add_study(CommandLine app);
/// `condyle friction`
Command add_friction(CommandLine app);
/// `condyle observability`
Command add_observability(CommandLine app);
/// `condyle protocol`
Command add_protocol(CommandLine app);
/// `condyle changes`
Command add_changes(CommandLine app);
/// `condyle tune`
Command add_tune(CommandLine app);
/// `condyle compare`
Command add_compare(CommandLine app);
/// `condyle bridge`
Command add_bridge(CommandLine app);
/// `condyle record`
Command add_record(CommandLine app);
/// `condyle live`, if it was built
Command add_live(CommandLine app);
/// `condyle session`
Command add_session(CommandLine app);
/// `condyle inspect`
Command add_inspect(CommandLine app);
/// `condyle doctor`
Command add_doctor(CommandLine app);
/// `condyle fake`
Command add_fake(CommandLine app);

/// Writes `text` to the standard output, or to the error output if an output file is "-"; throws
/// InputError if that is closed or full.
void print_output(const std::string& text);
/// The same; shows the error instead of throwing it, and returns false.
bool try_to_print(const std::string& text);
/// Writes "condyle: `text`" to the error output, if it is open.
void print_error(const std::string& text);

/// Reports that the user stopped the command, which leaves no file; returns its exit code.
int report_stop();

/// True once the user asked the program to stop (SIGINT, SIGTERM).
bool stop_requested();

}  // namespace condyle::host
