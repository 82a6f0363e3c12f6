#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <variant>

#include "engine/field/polynomial_form.h"
#include "engine/field/sample_rect.h"
#include "engine/field/shape_form.h"

namespace fettle::engine {

/// The nominal form of a surface over a field: a polynomial or a shape. Immutable; any thread.
class NominalForm {
 public:
  /// The height 0 of a field of one sample; may be assigned to.
  NominalForm() : form_(PolynomialForm{0, 1, 1, 0.0, {0.0}}) {}
  NominalForm(PolynomialForm form) noexcept  // NOLINT(google-explicit-constructor): each is a form
      : form_(std::move(form)) {}
  NominalForm(const ShapeForm& form) noexcept : form_(form) {}  // NOLINT(google-explicit-constructor)

  /// Of the field [samples].
  [[nodiscard]] std::int32_t width() const noexcept {
    return std::visit([](const auto& form) { return form.width; }, form_);
  }
  [[nodiscard]] std::int32_t height() const noexcept {
    return std::visit([](const auto& form) { return form.height; }, form_);
  }

  /// Height at sample (column, row), also between and beyond samples [height_unit]; finite.
  [[nodiscard]] double heightAt(double column, double row) const noexcept {
    return std::visit([&](const auto& form) { return form.heightAt(column, row); }, form_);
  }
  /// Heights of the samples of a rectangle of at most kTileSide + 1 columns, row-major, `stride` >= its columns. The same
  /// numbers give the same bits on every machine.
  void readHeights(const SampleRect& rect, double* out, std::ptrdiff_t stride) const noexcept {
    std::visit([&](const auto& form) { form.readHeights(rect, out, stride); }, form_);
  }
  /// The form of the field upside down: its heights are the negated ones, bit by bit.
  [[nodiscard]] NominalForm inverted() const;

  [[nodiscard]] const PolynomialForm* polynomial() const noexcept {
    return std::get_if<PolynomialForm>(&form_);
  }
  [[nodiscard]] const ShapeForm* shape() const noexcept { return std::get_if<ShapeForm>(&form_); }

  friend bool operator==(const NominalForm&, const NominalForm&) = default;

 private:
  std::variant<PolynomialForm, ShapeForm> form_;
};

}  // namespace fettle::engine
