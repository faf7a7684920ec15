// SPDX-License-Identifier: Apache-2.0
#include "hosted/files/last_words.h"

#include <unistd.h>

#include <cstdio>
#include <new>
#include <system_error>

namespace condyle::host {
namespace {

const char* ending_program = "";
int ending_code = 1;

[[noreturn]] void end() {
  int code = ending_code;
  try {
    if (std::current_exception()) std::rethrow_exception(std::current_exception());
    std::fprintf(stderr, "%s: internal error: the program was terminated; please report it\n",
                 ending_program);
  } catch (const std::exception& error) {
    code = say_last_words(ending_program, error, ending_code);
  } catch (...) {
    std::fprintf(stderr, "%s: internal error; please report it\n", ending_program);
  }
  _exit(code);
}

}  // namespace

int say_last_words(const char* program, const std::exception& error, int otherwise) noexcept {
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) {
    std::fprintf(stderr,
                 "%s: there is not enough memory; raise its limit (ulimit -v, MemoryMax of a "
                 "service)\n",
                 program);
    return kExitNoRoom;
  }
  const auto* const system = dynamic_cast<const std::system_error*>(&error);
  if (system != nullptr && system->code() == std::errc::resource_unavailable_try_again) {
    std::fprintf(
        stderr,
        "%s: no more threads can be started; raise the limits of memory and threads (ulimit "
        "-v and -u, MemoryMax and TasksMax of a service)\n",
        program);
    return kExitNoRoom;
  }
  std::fprintf(stderr, "%s: internal error: %s; please report it\n", program, error.what());
  return otherwise;
}

void end_with_last_words(const char* program, int otherwise) noexcept {
  ending_program = program;
  ending_code = otherwise;
  std::set_terminate(end);
}

}  // namespace condyle::host
