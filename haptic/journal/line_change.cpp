#include "haptic/journal/line_change.h"

#include <cstdint>
#include <utility>

#include "engine/session/line_codec.h"
#include "haptic/journal/mark_codec.h"

namespace fettle::haptic {

namespace {

constexpr std::size_t kLengthBytes = 8;

tl::unexpected<engine::Error> unreadable() {
  return engine::inputError("recorded lines cannot be read", "journal");
}

}  // namespace

std::string packLineChange(const engine::Version& before, const engine::Version& after) {
  const std::string marks = packMarkChanges(before, after);
  std::string out;
  for (std::size_t i = 0; i < kLengthBytes; ++i)
    out += static_cast<char>(std::uint64_t{marks.size()} >> (8 * i));
  return out + marks + engine::packLines(after.lines());
}

engine::Result<engine::Version> applyLineChange(const engine::Version& before, std::string_view change) {
  if (change.size() < kLengthBytes) return unreadable();
  std::uint64_t length = 0;
  for (std::size_t i = 0; i < kLengthBytes; ++i)
    length |= std::uint64_t{static_cast<std::uint8_t>(change[i])} << (8 * i);
  change.remove_prefix(kLengthBytes);
  if (length > change.size()) return unreadable();
  auto lines = engine::unpackLines(change.substr(length));
  if (!lines) return unreadable();
  auto marked = applyMarkChanges(before, change.substr(0, length));
  if (!marked) return marked;
  return marked->withLines(*std::move(lines));
}

}  // namespace fettle::haptic
