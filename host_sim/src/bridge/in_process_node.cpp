// SPDX-License-Identifier: Apache-2.0
#include "bridge/in_process_node.h"

#include <sys/socket.h>

#include <memory>

#include "hosted/files/input_error.h"

namespace condyle::host {

hal::GreetingMessage InProcessNode::Target::greeting() {
  hal::GreetingMessage greeting;
  greeting.software_version = hal::fixed_text(CONDYLE_VERSION);
  greeting.core_name = hal::fixed_text("this computer");
  return greeting;
}

InProcessNode::InProcessNode(unsigned scalar_size, hal::Clock& clock) : near_(clock), far_(clock) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends) != 0) {
    throw InputError("a pair of sockets", "cannot be made", "close other programs");
  }
  near_.adopt(ends[0]);
  far_.adopt(ends[1]);
  thread_ = std::thread([this, scalar_size, &clock] {
    if (scalar_size == sizeof(float)) {
      std::make_unique<firmware::EstimatorNode<float>>(far_, clock, target_)->serve();
    } else {
      std::make_unique<firmware::EstimatorNode<double>>(far_, clock, target_)->serve();
    }
  });
}

InProcessNode::~InProcessNode() {
  near_.close();  // ends the thread's read
  thread_.join();
}

}  // namespace condyle::host
