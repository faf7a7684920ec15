// SPDX-License-Identifier: Apache-2.0
// CONDYLE_UNDER_SANITIZER: 1 where the address or thread sanitizer, by GCC or clang, is in this
// build: memory is then larger, time longer and malloc taken.
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
