#pragma once

namespace fettle::app {

/// The calling thread has the processor only where the window leaves it, as far as the system keeps to that (a ninth of what
/// that gets): for work that a person may wait for, but that must not delay the picture. Its priority is normal where the window comes
/// before other work, else nice 10. It stays so: without privileges a thread cannot go back.
///
/// Not farther behind than it has to be: who adds a page or maps memory holds a lock of the process meanwhile, and the window waits for
/// it. Of nice 10 beside processes that spin such a thread does not get on for a tenth of a second.
void goBehindTheWindow() noexcept;

/// The calling thread, and those that it starts from now on, come before threads of normal priority where the system allows
/// it (nice -10, nine times what they get): for the thread that draws, before it makes the graphics device, whose threads
/// draw with it, and before others go behind it. Returns whether it was allowed; otherwise all is as before.
bool comeBeforeOtherWork() noexcept;

/// Starts all workers of TBB, which stay until the program ends, and puts them behind the window. Threads that begin a
/// parallel loop stay as they are. Returns how many workers went; a few milliseconds. Throws std::system_error where there
/// are no more threads.
int putWorkersBehindTheWindow();

}  // namespace fettle::app
