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

}  // namespace condyle::host
