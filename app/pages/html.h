#pragma once

#include <string>

namespace fettle::app {

// Pieces of pages that need no other file.

/// A text as HTML shows it: "&", "<", ">" and quotes written as entities.
[[nodiscard]] std::string escapedHtml(const std::string& text);

/// An <img> that holds the bytes of a PNG (RFC 2397, base64).
[[nodiscard]] std::string embeddedPng(const std::string& png, const std::string& description);

}  // namespace fettle::app
