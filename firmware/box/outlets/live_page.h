// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace condyle::box {

/// A page for browsers, and the policy that lets it load nothing from elsewhere.
struct WebPage {
  std::string text, content_policy;
};

/// The page at /: the live page; a few words if it was not built.
const WebPage& live_page();

}  // namespace condyle::box
