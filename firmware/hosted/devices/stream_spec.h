// SPDX-License-Identifier: Apache-2.0
// The notation of streams as sources, beside that of source_spec.h.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "hosted/lsl/stream_layout.h"

namespace condyle::host {

/// A stream of the Lab Streaming Layer as a source, written lsl:NAME or lsl:NAME@ADDRESS.
struct StreamSpec {
  std::string place;  ///< NAME or NAME@ADDRESS
  lsl::StreamChoice choice;
};

/// Parses `text`; none if it does not begin with lsl:. The place may be empty.
inline std::optional<StreamSpec> parse_stream(std::string_view text) {
  constexpr std::string_view kKind = "lsl:";
  if (!text.starts_with(kKind)) return std::nullopt;
  return StreamSpec{std::string(text.substr(kKind.size())), {}};
}

}  // namespace condyle::host
