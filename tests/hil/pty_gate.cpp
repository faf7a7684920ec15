// SPDX-License-Identifier: Apache-2.0
#include "hil/pty_gate.h"

#include <fcntl.h>
#include <pty.h>
#include <termios.h>

#include <cerrno>
#include <cstring>

#include "hosted/files/input_error.h"

namespace condyle::hil {

PtyGate::PtyGate() {
  int ours = -1, clients = -1;
  char path[128] = {};
  if (openpty(&ours, &clients, path, nullptr, nullptr) != 0) {
    throw host::InputError("pseudo-terminal", std::strerror(errno), "mount /dev/pts");
  }
  ours_ = host::fake::FileHandle(ours);
  clients_ = host::fake::FileHandle(clients);
  path_ = path;
  termios settings{};
  tcgetattr(clients, &settings);
  cfmakeraw(&settings);
  tcsetattr(clients, TCSANOW, &settings);
  for (const int file : {ours, clients}) {
    fcntl(file, F_SETFD, FD_CLOEXEC);
    fcntl(file, F_SETFL, O_NONBLOCK);  // of our descriptions, not of the client's own
  }
}

void PtyGate::ring() {
  if (ours_.is_open() && write(ours_.get(), "x", 1) != 1) {
    throw host::InputError("pseudo-terminal", "is full", "this is a defect of the fake device");
  }
}

void PtyGate::unring() {
  char byte = 0;
  if (clients_.is_open() && read(clients_.get(), &byte, 1) != 1) {
    throw host::InputError("pseudo-terminal", "is empty", "this is a defect of the fake device");
  }
}

void PtyGate::silence() {
  if (clients_.is_open()) tcflush(clients_.get(), TCIFLUSH);
}

void PtyGate::allow_output(bool allowed) {
  if (clients_.is_open()) tcflow(clients_.get(), allowed ? TCOON : TCOOFF);
}

void PtyGate::hang_up() {
  ours_.reset();
  clients_.reset();
}

}  // namespace condyle::hil
