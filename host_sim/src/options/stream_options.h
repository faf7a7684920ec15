// SPDX-License-Identifier: Apache-2.0
// The options for streams of the Lab Streaming Layer. The second argument must outlive the command.
#pragma once

#include <string>

#include "hosted/lsl/stream_layout.h"
#include "options/command_line.h"

namespace condyle::host {

/// --channels and --unit: what the channels of a stream are.
void add_stream_options(CommandLine command, lsl::StreamChoice& choice);

/// --lsl-out: the streams in which estimates and markers are offered.
void add_stream_outlet_option(CommandLine command, std::string& place);

/// Throws an InputError if they are given for another source than a stream.
void refuse_without_stream(const lsl::StreamChoice& choice, bool is_stream);

}  // namespace condyle::host
