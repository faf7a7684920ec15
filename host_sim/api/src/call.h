// SPDX-License-Identifier: Apache-2.0
// What every function of the C interface does: no exception leaves it, and its error is kept as
// text for the calling thread.
#pragma once

#include <functional>
#include <new>
#include <stdexcept>
#include <string>

#include "condyle.h"
#include "hosted/files/input_error.h"
#include "options/command_line.h"

namespace condyle::host {

/// An argument that cannot be: a mistake of the calling program.
class Misuse : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws Misuse unless `holds`.
inline void demand(bool holds, const char* problem) {
  if (!holds) throw Misuse(problem);
}

/// Keeps `function: text` for condyle_last_error(), and returns `status`.
condyle_status fail(condyle_status status, const char* function, const char* text) noexcept;
/// Forgets the last error.
void forget_error() noexcept;

/// Does `work`, which returns a status, and turns what it throws into one.
template <class Work>
condyle_status guarded(const char* function, const Work& work) noexcept {
  forget_error();
  try {
    return work();
  } catch (const Misuse& error) {
    return fail(CONDYLE_BAD_CALL, function, error.what());
  } catch (const InputError& error) {
    return fail(CONDYLE_BAD_INPUT, "", error.what());
  } catch (const std::bad_alloc&) {
    return fail(CONDYLE_FAILED, function, "memory ran out; give less data at once");
  } catch (const std::exception& error) {
    return fail(CONDYLE_FAILED, function, error.what());
  } catch (...) {
    return fail(CONDYLE_FAILED, function, "an unknown fault");
  }
}

/// Parses the words `options` with the options that `add` gives to a command line. Throws
/// InputError for an unknown option or a bad value, Misuse for NULL.
void parse_options(const char* function, const char* const* options, std::size_t count,
                   const std::function<void(CommandLine)>& add);

/// `text`, which must not be NULL; `what` begins the message.
std::string given_text(const char* text, const char* what);

}  // namespace condyle::host
