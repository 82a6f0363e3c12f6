#include "app/texts/texts.h"

#include <array>
#include <optional>

#include "app/texts/format_fields.h"

namespace fettle::app {
namespace {

std::optional<Catalogue>& catalogueInUse() {
  static std::optional<Catalogue> catalogue;
  return catalogue;
}

}  // namespace

void useTexts(Catalogue catalogue) {
  catalogueInUse() = std::move(catalogue);
}

void useSourceTexts() {
  catalogueInUse().reset();
}

bool textsAreTranslated() noexcept {
  return catalogueInUse().has_value();
}

const char* tr(const char* text) noexcept {
  const auto& catalogue = catalogueInUse();
  if (!catalogue || *text == '\0') return text;
  const char* const found = catalogue->find(text);
  return found != nullptr ? found : text;
}

std::string_view tr(std::string_view text) noexcept {
  const auto& catalogue = catalogueInUse();
  if (!catalogue || text.empty()) return text;
  const char* const found = catalogue->find(text);
  return found != nullptr ? std::string_view(found) : text;
}

const char* trPrintf(const char* format) noexcept {
  const char* const found = tr(format);
  return found == format || sameConversions(format, found) ? found : format;
}

std::string_view trForm(std::string_view one, std::string_view many, unsigned long long n) noexcept {
  const auto& catalogue = catalogueInUse();
  const char* const found = catalogue ? catalogue->find(one, many, n) : nullptr;
  return found != nullptr ? std::string_view(found) : n == 1 ? one : many;
}

const char* labelOf(const char* label) {
  if (!textsAreTranslated()) return label;
  const std::string_view whole = label, name = whole.substr(0, whole.find("##"));
  const std::string_view shown = tr(name);
  if (name.empty() || shown.data() == name.data()) return label;
  static std::array<std::string, 8> labels;
  static std::size_t next = 0;
  std::string& made = labels[next];
  next = (next + 1) % labels.size();
  const std::size_t own = whole.find("###");
  made.assign(shown).append(own == std::string_view::npos ? "###" : "");
  made.append(own == std::string_view::npos ? whole : whole.substr(own));
  return made.c_str();
}

}  // namespace fettle::app
