#include "render/plan/font_data.h"

// .incbin lets the assembler copy the files in; as a C++ array they would take minutes to compile.
__asm__(
    ".section .rodata\n"
    ".balign 16\n"
    "fettle_font_regular_begin:\n"
    ".incbin \"" FETTLE_FONT_FOLDER
    "/DejaVuSans.ttf\"\n"
    "fettle_font_regular_end:\n"
    ".balign 16\n"
    "fettle_font_bold_begin:\n"
    ".incbin \"" FETTLE_FONT_FOLDER
    "/DejaVuSans-Bold.ttf\"\n"
    "fettle_font_bold_end:\n"
    ".text\n");

extern "C" {
extern const std::uint8_t fettle_font_regular_begin[];
extern const std::uint8_t fettle_font_regular_end[];
extern const std::uint8_t fettle_font_bold_begin[];
extern const std::uint8_t fettle_font_bold_end[];
}

namespace fettle::render {

std::span<const std::uint8_t> regularFont() noexcept {
  return {fettle_font_regular_begin, fettle_font_regular_end};
}
std::span<const std::uint8_t> boldFont() noexcept {
  return {fettle_font_bold_begin, fettle_font_bold_end};
}

}  // namespace fettle::render
