#pragma once

namespace fettle::app {

/// How loud the sound of a session is: of the person and the room, not of the scene.
struct Loudness {
  float volume = 0.5F;  ///< 0 .. 1
  bool muted = false;

  friend bool operator==(const Loudness&, const Loudness&) = default;
};

}  // namespace fettle::app
