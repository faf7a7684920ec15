// SPDX-License-Identifier: Apache-2.0
#pragma once

/// After a function's parameters: it takes no memory and no lock and makes no call that may block.
/// RealtimeSanitizer (clang 20 and later, preset rtsan) ends a program in which it does.
#if defined(__has_cpp_attribute)
#if __has_cpp_attribute(clang::nonblocking)
#define CONDYLE_NONBLOCKING [[clang::nonblocking]]
#endif
#endif
#ifndef CONDYLE_NONBLOCKING
#define CONDYLE_NONBLOCKING
#endif
