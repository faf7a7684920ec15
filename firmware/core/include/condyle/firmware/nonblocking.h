// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Placed after a function's parameters: the function allocates no memory, takes no lock and makes
/// no blocking call. RealtimeSanitizer (clang 20 and later, preset rtsan) ends a program that
/// breaks this.
#if defined(__has_cpp_attribute)
#if __has_cpp_attribute(clang::nonblocking)
#define CONDYLE_NONBLOCKING [[clang::nonblocking]]
#endif
#endif
#ifndef CONDYLE_NONBLOCKING
#define CONDYLE_NONBLOCKING
#endif
