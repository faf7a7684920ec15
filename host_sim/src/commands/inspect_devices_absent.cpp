// SPDX-License-Identifier: Apache-2.0
// `condyle inspect` where condyle reads no devices: on Windows.
#include "commands/inspect_devices.h"
#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

[[noreturn]] void refuse() {
  throw InputError("inspect", "condyle reads devices on Linux only",
                   "give a report descriptor in a file with --descriptor FILE");
}

}  // namespace

int list_devices(const InspectOptions&) {
  refuse();
}

int inspect_device(const InspectOptions&) {
  refuse();
}

}  // namespace condyle::host
