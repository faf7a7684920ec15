// SPDX-License-Identifier: Apache-2.0
// CONDYLE_UNDER_SANITIZER: 1 if this build has the address or thread sanitizer of GCC or clang. It
// then needs more memory and time, and malloc is already replaced.
#pragma once

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CONDYLE_UNDER_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define CONDYLE_UNDER_SANITIZER 1
#endif
#endif
#ifndef CONDYLE_UNDER_SANITIZER
#define CONDYLE_UNDER_SANITIZER 0
#endif
