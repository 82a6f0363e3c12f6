#include "engine/base/thread_priority.h"

#include <sys/resource.h>
#include <unistd.h>

namespace fettle::engine {

void takeNormalPriority() noexcept {
  // On Linux the number is of a thread, not of its process.
  const auto thread = static_cast<id_t>(gettid());
  if (getpriority(PRIO_PROCESS, thread) < 0) static_cast<void>(setpriority(PRIO_PROCESS, thread, 0));
}

}  // namespace fettle::engine
