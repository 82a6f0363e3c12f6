#include "haptic/journal/mark_codec.h"

#include <array>
#include <cstdint>
#include <utility>

#include "engine/field/difference.h"
#include "engine/field/live_field.h"
#include "engine/session/line_codec.h"

namespace fettle::haptic {

namespace {

using engine::kTileSide;
constexpr std::size_t kBitBytes = engine::kTileSamples / 8;
constexpr std::size_t kTileBytes = 8 + 2 * kBitBytes;

void put32(std::string& out, std::int32_t value) {
  for (int shift = 0; shift < 32; shift += 8)
    out += static_cast<char>(static_cast<std::uint32_t>(value) >> shift);
}

std::int32_t get32(std::string_view in) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::uint32_t{static_cast<std::uint8_t>(in[i])} << (8 * i);
  return static_cast<std::int32_t>(value);
}

constexpr std::size_t kLengthBytes = 8;

tl::unexpected<engine::Error> unreadable() {
  return engine::inputError("recorded lines cannot be read", "journal");
}

}  // namespace

std::string packMarkChanges(const engine::Version& before, const engine::Version& after) {
  std::string out;
  for (const engine::TileChange& change : engine::changedTiles(before, after)) {
    std::array<std::uint8_t, 2 * kBitBytes> bits{};  // which change; what to
    bool any = false;
    for (int r = 0; r < kTileSide; ++r)
      for (int c = 0; c < kTileSide; ++c) {
        if (change.before->marked(c, r) == change.after->marked(c, r)) continue;
        const auto i = static_cast<std::size_t>(r * kTileSide + c);
        const auto bit = static_cast<std::uint8_t>(1U << (i % 8));
        bits[i / 8] |= bit;
        if (change.after->marked(c, r)) bits[kBitBytes + i / 8] |= bit;
        any = true;
      }
    if (!any) continue;
    put32(out, change.tile_column);
    put32(out, change.tile_row);
    out.append(bits.begin(), bits.end());
  }
  return out;
}

engine::Result<engine::Version> applyMarkChanges(const engine::Version& before, std::string_view changes) {
  const engine::FieldReader reader = before.reader();
  const engine::Grid& grid = before.grid();
  engine::LiveField field(before, engine::Growth::kAllowed);
  if (changes.size() % kTileBytes != 0) return engine::inputError("recorded marks are cut short", "journal");
  for (std::size_t at = 0; at < changes.size(); at += kTileBytes) {
    const std::int32_t tc = get32(changes.substr(at));
    const std::int32_t tr = get32(changes.substr(at + 4));
    if (tc < 0 || tr < 0 || tc >= reader.tileColumns() || tr >= reader.tileRows())
      return engine::inputError("recorded marks lie outside the field", "journal");
    const auto bit = [&](std::size_t from, int i) {
      const auto byte = static_cast<std::uint8_t>(changes[from + static_cast<std::size_t>(i / 8)]);
      return (byte >> (i % 8) & 1) != 0;
    };
    for (int i = 0; i < engine::kTileSamples; ++i) {
      if (!bit(at + 8, i)) continue;
      const int c = i % kTileSide, r = i / kTileSide;
      const std::int32_t column = tc * kTileSide + c, row = tr * kTileSide + r;
      if (column >= grid.width || row >= grid.height)
        return engine::inputError("recorded marks lie outside the field", "journal");
      if (!field.setMark(column, row, bit(at + 8 + kBitBytes, i)))
        return engine::failure("memory for marks could not be allocated", "journal", "close other programs");
    }
  }
  return field.snapshot();
}

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
