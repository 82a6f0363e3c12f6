#pragma once

namespace fettle::app {

/// Notes that a thread does not come back from a library's call and was left there. Threading: any.
void noteThreadLeft() noexcept;

/// The last call of main(): returns `status`. Where a thread was left it ends the process with it at once instead: what is
/// destroyed at the end of a process that thread may still use.
[[nodiscard]] int endOfMain(int status);

}  // namespace fettle::app
