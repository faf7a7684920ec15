// SPDX-License-Identifier: Apache-2.0
// `main` of the test programs as images.
#include "condyle/cortex_m/board.h"
#include "semihosting.h"
#include "test_host.h"

// A test image is started once. A second start is the end of a fault.
int main() {
  using namespace condyle;
  cortex_m::FaultRecord fault;
  if (cortex_m::last_fault(fault)) {
    cross::print_hexadecimal("fault: exception ", fault.exception);
    cross::print_hexadecimal(" pc ", fault.pc);
    cross::print_hexadecimal(" lr ", fault.lr);
    cross::print_hexadecimal(" cfsr ", fault.cfsr);
    cross::print_hexadecimal(" hfsr ", fault.hfsr);
    cross::print("\n");
    cross::end(101);
  }
  static char line[512];
  const char* arguments[8];
  int count = 0;
  if (cross::command_line(line, sizeof line)) {
    for (char* at = line; *at != '\0' && count < 8;) {
      arguments[count++] = at;
      while (*at != '\0' && *at != ' ') ++at;
      if (*at == ' ') *at++ = '\0';
    }
  }
  cross::end(cross::test_program(count > 0 ? count - 1 : 0, arguments + 1));
}
