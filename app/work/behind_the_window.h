#pragma once

namespace fettle::app {

/// The calling thread has the processor only where threads of normal priority leave it, as far as the system keeps to that
/// (nice 10, a ninth of what they get): for work that a person may wait for, but that must not delay the picture. For
/// good: without privileges a thread cannot go back.
void goBehindTheWindow() noexcept;

/// Starts all workers of TBB, which stay until the program ends, and puts them behind the window. Threads that begin a
/// parallel loop stay as they are. Returns how many workers went; a few milliseconds. Throws std::system_error where there
/// are no more threads.
int putWorkersBehindTheWindow();

}  // namespace fettle::app
