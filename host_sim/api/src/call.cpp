// SPDX-License-Identifier: Apache-2.0
#include "call.h"

#include <vector>

#include "condyle/estimator/impedance/impedance_estimate.h"
#include "condyle/estimator/sample.h"

namespace condyle::host {
namespace {

std::string& last_error() {
  thread_local std::string text;
  return text;
}

}  // namespace

condyle_status fail(condyle_status status, const char* function, const char* text) noexcept {
  try {
    last_error() = (*function != '\0' ? std::string(function) + ": " : "") + text;
  } catch (...) {
    last_error().clear();  // no memory for the text; the status remains
  }
  return status;
}

void forget_error() noexcept {
  last_error().clear();
}

void parse_options(const char* function, const char* const* options, std::size_t count,
                   const std::function<void(CommandLine)>& add) {
  if (count == 0) return;
  demand(options != nullptr, "options is NULL; give as many as option_count says");
  std::vector<const char*> words = {function};
  for (std::size_t i = 0; i < count; ++i) {
    demand(options[i] != nullptr, "one of the options is NULL; give words such as \"--lag=8\"");
    words.push_back(options[i]);
  }
  Program program(function, CONDYLE_VERSION, "");
  add(program.line());
  std::string text;
  switch (program.parse(static_cast<int>(words.size()), words.data(), text)) {
    case Program::Parsed::run:
      return;
    case Program::Parsed::answered:
      throw InputError(std::string(function) +
                       ": help and version are no options here; leave them out");
    case Program::Parsed::wrong:
      // The second line names the command's --help.
      throw InputError(text.substr(0, text.find('\n')) +
                       "; the options are those of the command condyle, see condyle help");
  }
}

std::string given_text(const char* text, const char* what) {
  if (text == nullptr || *text == '\0') {
    throw Misuse(std::string(what) + (text == nullptr ? " is NULL" : " is empty") + "; give one");
  }
  return text;
}

}  // namespace condyle::host

using namespace condyle;

const char* condyle_version(void) {
  return CONDYLE_VERSION;
}

const char* condyle_last_error(void) {
  return host::last_error().c_str();
}

const char* condyle_provenance_name(int provenance) {
  const bool exists = provenance >= CONDYLE_NOT_COMPUTED && provenance <= CONDYLE_MEASURED;
  return exists ? provenance_name(static_cast<Provenance>(provenance)) : "";
}

int condyle_event_count(void) {
  return static_cast<int>(kEventCount);
}

const char* condyle_event_name(int bit) {
  return bit >= 0 && bit < condyle_event_count() ? event_name(static_cast<Event>(bit)) : "";
}

int condyle_limit_count(void) {
  return static_cast<int>(kImpedanceLimits);
}

const char* condyle_limit_name(int limit) {
  return limit >= 0 && limit < condyle_limit_count()
             ? limit_name(static_cast<ImpedanceLimit>(limit))
             : "";
}

size_t condyle_coordinate_count(int kind) {
  return kind >= CONDYLE_ONE_AXIS && kind <= CONDYLE_POSE
             ? coordinate_count(static_cast<SampleKind>(kind))
             : 0;
}
