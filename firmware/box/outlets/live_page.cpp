// SPDX-License-Identifier: Apache-2.0
#include "box/outlets/live_page.h"

#include <fmt/format.h>

#ifdef CONDYLE_HAS_LIVE_PAGE
#include <string_view>

#include "box/outlets/live_page_text.h"
#endif

namespace condyle::box {
namespace {

#ifdef CONDYLE_HAS_LIVE_PAGE
std::string markup_as_text(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else {
      result += c;
    }
  }
  return result;
}

WebPage make_page() {
  return {fmt::format("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
                      "<title>condyle live</title>\n<link rel=\"icon\" href=\"data:,\">\n"
                      "<style>{}</style>\n</head>\n<body>\n{}"
                      "<footer><details><summary>Licence of uPlot, which draws the charts</summary>"
                      "<pre>{}</pre></details></footer>\n<script>{}</script>\n</body>\n</html>\n",
                      kPageStyle, kPageBody, markup_as_text(kPageLicence), kPageScript),
          fmt::format("default-src 'none'; script-src '{}'; style-src '{}'; connect-src 'self'; "
                      "img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
                      kPageScriptHash, kPageStyleHash)};
}
#else
WebPage make_page() {
  return {
      "<!DOCTYPE html><html lang=\"en\"><meta charset=\"utf-8\"><title>condyle box</title>"
      "<h1>condyle box</h1><p>It records and estimates jaw motion. Research use only; not "
      "a diagnosis.</p><p>Its state is at <code>/v1/status</code>, its estimates at "
      "<code>/v1/estimates</code>. The live page was left out when this program was built."
      "</p></html>\n",
      "default-src 'none'; frame-ancestors 'none'"};
}
#endif

}  // namespace

const WebPage& live_page() {
  static const WebPage page = make_page();
  return page;
}

}  // namespace condyle::box
