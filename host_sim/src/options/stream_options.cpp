// SPDX-License-Identifier: Apache-2.0
#include "options/stream_options.h"

#include "hosted/files/input_error.h"

namespace condyle::host {

void add_stream_options(CommandLine line, lsl::StreamChoice& choice) {
  const CommandLine command = line.group("Streams");
  command
      .add_option("--channels=NAME,...", choice.channels,
                  "Channels of an LSL stream that are the position, by label or number from 1: 1, "
                  "3 (x,y,z), 7 (and a quaternion w,x,y,z) or 9 (three points)")
      .one_value_each()
      .separated_by(',');
  command.add_option("--unit", choice.unit, "Unit of an LSL stream that states none")
      .one_of({"m", "cm", "mm", "um"});
}

void add_stream_outlet_option(CommandLine line, std::string& place) {
  line.group("Streams").add_option(
      "--lsl-out=NAME[@ADDRESS]", place,
      "Offer estimates and markers as the LSL streams NAME and NAME-markers, at an IPv4 address of "
      "this computer; default: 127.0.0.1, this computer only");
}

void refuse_without_stream(const lsl::StreamChoice& choice, bool is_stream) {
  if (is_stream) return;
  const char* const option = !choice.channels.empty() ? "--channels"
                             : !choice.unit.empty()   ? "--unit"
                                                      : nullptr;
  if (option == nullptr) return;
  throw InputError(option, "applies only to streams, lsl:NAME", "leave it out");
}

}  // namespace condyle::host
