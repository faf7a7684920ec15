// SPDX-License-Identifier: Apache-2.0
// Script and style of a report, bundled at build time (toolchain/web_page.cmake).
#pragma once

namespace condyle::host {

extern const char* const kPageScript;      ///< JavaScript
extern const char* const kPageStyle;       ///< CSS
extern const char* const kPageLicence;     ///< of the parts of others in both
extern const char* const kPageScriptHash;  ///< for the content policy
extern const char* const kPageStyleHash;

}  // namespace condyle::host
