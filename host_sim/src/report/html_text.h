// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "hosted/files/clean_text.h"

namespace condyle::host {

/// `text` on one line as the content of an HTML or SVG element or of a quoted attribute: markup
/// appears as text.
inline std::string html_text(std::string_view text) {
  std::string result;
  for (const char c : clean_line(text)) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

/// A reason that condyle gives: as on a terminal, but with a plus-minus sign.
inline std::string reason_html(std::string_view reason) {
  std::string result = html_text(reason);
  for (std::size_t at = 0; (at = result.find("+-", at)) != std::string::npos; ++at) {
    result.replace(at, 2, "&plusmn;");
  }
  return result;
}

}  // namespace condyle::host
