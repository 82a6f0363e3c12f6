#pragma once

#include <string_view>

namespace fettle::app {

/// Whether a translation may be formatted by fmt with the arguments of its source: each of its replacement fields is one of the
/// source's, with the same format, by its number ("{1}") or its order. It may leave fields out. False for what is no format at all.
[[nodiscard]] bool fitsFields(std::string_view source, std::string_view translation);

/// Whether two formats of printf have the same conversions in the same order.
[[nodiscard]] bool sameConversions(std::string_view source, std::string_view translation) noexcept;

}  // namespace fettle::app
