// SPDX-License-Identifier: Apache-2.0
// The texts of the live page, bundled at build time (toolchain/web_page.cmake).
#pragma once

namespace condyle::box {

extern const char* const kPageBody;        ///< HTML
extern const char* const kPageScript;      ///< JavaScript
extern const char* const kPageStyle;       ///< CSS
extern const char* const kPageLicence;     ///< of the parts of others in both
extern const char* const kPageScriptHash;  ///< for the content policy
extern const char* const kPageStyleHash;

}  // namespace condyle::box
