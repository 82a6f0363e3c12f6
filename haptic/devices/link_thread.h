#pragma once

namespace fettle::haptic {

/// Of the calling thread, which talks with a device: its name, and a priority above ordinary programs where the system allows it, below
/// the loop's, which never waits for it.
void becomeLinkThread(const char* name) noexcept;

}  // namespace fettle::haptic
