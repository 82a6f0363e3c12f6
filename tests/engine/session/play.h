#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/field/version.h"
#include "engine/session/session.h"
#include "engine/session/session_writer.h"

namespace fettle::engine {

/// Someone at work whose every action follows from a seed and the number of the action: what a program did
/// before it was killed can be done again and compared bit by bit.
class Play {
 public:
  /// Begins with a field of this size that has all a float can be: holes of several kinds of NaN, zeros of
  /// both signs, denormals; marks; a border that cuts tiles.
  Play(std::uint64_t seed, std::int32_t width, std::int32_t height);
  /// Continues a session that such a play has made; `actions` is how many it holds.
  Play(std::uint64_t seed, const Session& session);

  /// Does action number actions() + 1: stroke, filter, mark, inversion, undo, redo or a text; hands it to the
  /// writer unless that is null. Every action leaves one entry in the journal.
  void act(SessionWriter* writer);

  [[nodiscard]] std::int64_t actions() const noexcept {
    return static_cast<std::int64_t>(session.journal.size());
  }

  Session session;

 private:
  std::uint64_t seed_;
};

/// A field as Play begins with.
[[nodiscard]] Version strangeField(std::uint64_t seed, std::int32_t width, std::int32_t height);

/// The first thing in which two sessions differ - any bit of any state that both hold, any count, number,
/// name, text - or an empty text. `whole`: both must hold the same states.
enum class Compare : std::uint8_t { kWhole, kHeldByBoth };
[[nodiscard]] std::string difference(const Session& a, const Session& b, Compare compare);

/// What a session file holds otherwise than `session`: the first difference, or why it cannot be opened, or
/// what its checksums say; empty if nothing.
[[nodiscard]] std::string differenceOnDisk(const Session& session, const std::string& path);

/// The first bit in which two versions differ, bounds and counts of their tiles included; empty if none.
[[nodiscard]] std::string difference(const Version& a, const Version& b);

}  // namespace fettle::engine
