// SPDX-License-Identifier: Apache-2.0
// How the node of a test image fails: CONDYLE_FAULTING, CONDYLE_HANGING or CONDYLE_ERRING.
extern "C" void fail_node();

extern "C" void fail_node() {
#if defined(CONDYLE_FAULTING)
  asm volatile("udf #0");
#elif defined(CONDYLE_HANGING)
  for (volatile bool forever = true; forever;) {
  }
#elif !defined(CONDYLE_ERRING)
#error "say how: CONDYLE_FAULTING, CONDYLE_HANGING or CONDYLE_ERRING"
#endif
}
