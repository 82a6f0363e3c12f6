#include "app/files/import_form.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include <fmt/format.h>

namespace fettle::app {
namespace {

// As numbers are typed: blanks around them, a plus sign, and a comma for the point where there is no point.
std::optional<double> numberOf(std::string text) {
  std::erase(text, ' ');
  if (text.starts_with('+')) text.erase(0, 1);
  if (text.find('.') == std::string::npos)
    if (const std::size_t comma = text.find(','); comma != std::string::npos) text[comma] = '.';
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || text.empty()) return std::nullopt;
  return value;
}

enum class Takes : std::uint8_t { kPositive, kNotZero, kAny };

const char* remedyOf(Takes takes) {
  switch (takes) {
    case Takes::kPositive:
      return "give a number above 0, or nothing";
    case Takes::kNotZero:
      return "give a number other than 0, or nothing";
    case Takes::kAny:
      break;
  }
  return "give a number, or nothing";
}

// Nothing for an empty text.
engine::Result<std::optional<double>> read(const std::string& text, const char* field, Takes takes) {
  if (text.find_first_not_of(' ') == std::string::npos) return std::nullopt;
  const auto value = numberOf(text);
  const bool fits =
      value && (takes == Takes::kAny ||
                (std::isfinite(*value) && (takes == Takes::kNotZero ? *value != 0.0 : *value > 0.0)));
  if (!fits) return engine::inputError(fmt::format("\"{}\" is no such number", text), field, remedyOf(takes));
  return value;
}

engine::Status addSpacing(const ImportForm& form, ScanOptions& options) {
  const auto x = read(form.spacing_x, "spacing", Takes::kPositive);
  if (!x) return tl::unexpected(x.error());
  const auto y = read(form.spacing_y, "spacing", Takes::kPositive);
  if (!y) return tl::unexpected(y.error());
  if (*x) options.spacing = {**x, y->value_or(**x)};
  if (!*x && *y)
    return engine::inputError("that of the columns is missing", "spacing", "give both, or the first");
  return {};
}

engine::Status addCamera(const ImportForm& form, ScanOptions& options) {
  constexpr const char* kField = "depth camera";
  std::array<std::optional<double>, 4> camera;
  for (std::size_t i = 0; i < form.camera.size(); ++i) {
    const auto value = read(form.camera[i], kField, i < 2 ? Takes::kPositive : Takes::kAny);
    if (!value) return tl::unexpected(value.error());
    camera[i] = *value;
  }
  const auto [fx, fy, cx, cy] = camera;
  if (!fx && (fy || cx || cy)) return engine::inputError("its focal length fx is missing", kField, "give it");
  if (cx.has_value() != cy.has_value())
    return engine::inputError("of its axis cx, cy one is missing", kField, "give both, or none");
  if (fx) options.depth_camera.push_back(*fx);
  if (fx && (fy || cx)) options.depth_camera.push_back(fy.value_or(*fx));
  if (fx && cx) options.depth_camera.insert(options.depth_camera.end(), {*cx, *cy});
  if (!options.depth_camera.empty() && !options.spacing.empty())
    return engine::inputError("it gives the spacing itself", kField, "leave the spacing empty");
  return {};
}

}  // namespace

ImportForm ImportForm::of(const ScanOptions& options) {
  const auto text = [](const std::optional<double>& value) { return value ? fmt::format("{}", *value) : ""; };
  ImportForm form;
  if (!options.spacing.empty()) {
    form.spacing_x = fmt::format("{}", options.spacing.front());
    if (options.spacing.back() != options.spacing.front())
      form.spacing_y = fmt::format("{}", options.spacing.back());
  }
  form.unit = options.unit;
  form.z_scale = text(options.z_scale);
  form.no_data = text(options.no_data);
  form.cell_size = text(options.cell_size);
  form.cell_rule = options.cell_rule;
  for (std::size_t i = 0; i < std::min(form.camera.size(), options.depth_camera.size()); ++i)
    form.camera[i] = fmt::format("{}", options.depth_camera[i]);
  return form;
}

engine::Result<ScanOptions> ImportForm::read() const {
  ScanOptions options;
  if (auto added = addSpacing(*this, options); !added) return tl::unexpected(added.error());
  if (auto added = addCamera(*this, options); !added) return tl::unexpected(added.error());
  const auto scale = app::read(z_scale, "z scale", Takes::kNotZero);
  if (!scale) return tl::unexpected(scale.error());
  const auto hole = app::read(no_data, "no data", Takes::kAny);
  if (!hole) return tl::unexpected(hole.error());
  const auto cell = app::read(cell_size, "cell size", Takes::kPositive);
  if (!cell) return tl::unexpected(cell.error());
  options.z_scale = *scale;
  options.no_data = *hole;
  options.cell_size = *cell;
  options.unit = unit;
  options.cell_rule = cell_rule;
  if (const auto known = importOptions(options); !known) return tl::unexpected(known.error());
  return options;
}

}  // namespace fettle::app
