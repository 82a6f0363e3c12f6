#pragma once

namespace fettle::app {

/// The calling thread has the processor only where threads of normal priority leave it, as far as the system keeps to that
/// (nice 10, a ninth of what they get): for work that a person may wait for, but that must not delay the picture. For
/// good: without privileges a thread cannot go back.
void goBehindTheWindow() noexcept;

/// The calling thread, and those that it starts from now on, come before threads of normal priority where the system allows
/// it (nice -10, nine times what they get): for the thread that draws, before it makes the graphics device, whose threads
/// draw with it. Returns whether it was allowed; otherwise all is as before.
bool comeBeforeOtherWork() noexcept;

/// Starts all workers of TBB, which stay until the program ends, and puts them behind the window. Threads that begin a
/// parallel loop stay as they are. Returns how many workers went; a few milliseconds. Throws std::system_error where there
/// are no more threads.
int putWorkersBehindTheWindow();

}  // namespace fettle::app
