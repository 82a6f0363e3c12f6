#pragma once

namespace fettle::engine {

/// The calling thread comes no longer before threads of normal priority (nice 0), as one does that was started by a thread
/// that draws. A thread that comes after them stays there.
void takeNormalPriority() noexcept;

}  // namespace fettle::engine
