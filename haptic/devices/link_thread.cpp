#include "haptic/devices/link_thread.h"

#include <pthread.h>

namespace fettle::haptic {

void becomeLinkThread(const char* name) noexcept {
  constexpr int kPriority = 60;
  pthread_setname_np(pthread_self(), name);
  const sched_param priority{.sched_priority = kPriority};
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority));
}

}  // namespace fettle::haptic
