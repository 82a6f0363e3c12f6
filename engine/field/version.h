#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "engine/field/edge_line.h"
#include "engine/field/grid.h"
#include "engine/field/node_pool.h"
#include "engine/field/reader.h"

namespace fettle::engine {

class LiveField;
class LineCuts;
class NominalForm;
class Version;
struct SeenPair;

/// The form that lies over a field, or null.
using FieldForm = std::shared_ptr<const NominalForm>;

/// What versions share beyond samples: where the samples lie, the edge lines between them, and the form over them.
struct FieldDescription {
  Grid grid;
  EdgeLines lines;
  std::shared_ptr<const LineCuts> cuts;  ///< null without lines
  FieldForm form;
  std::shared_ptr<const SeenPair> seen_of;
};

/// An immutable state of a field: samples, marks, edge lines, form, bounds, sign. Copying one is O(1) and allocates nothing;
/// versions share every tile in which they do not differ.
///
/// Threading: a Version may be copied and read from any thread. The last copy frees the tiles that no other
/// version holds, which takes time proportional to their number: destroy the last copy on a thread that has
/// the time.
class Version {
 public:
  Version() = default;
  Version(const Version& other) noexcept;
  Version(Version&& other) noexcept
      : description_(std::move(other.description_)),
        memory_(std::move(other.memory_)),
        root_(std::exchange(other.root_, nullptr)),
        sign_(other.sign_) {}
  Version& operator=(Version other) noexcept;
  ~Version() { releaseNode(root_); }

  [[nodiscard]] bool empty() const noexcept { return root_ == nullptr; }
  [[nodiscard]] const Grid& grid() const noexcept { return description_->grid; }
  [[nodiscard]] FieldReader reader() const noexcept { return {root_, &description_->grid, sign_}; }
  [[nodiscard]] const std::shared_ptr<FieldMemory>& memory() const noexcept { return memory_; }

  /// The same field upside down (z -> -z): a sign, no sample is touched; inverted().inverted() is the same.
  [[nodiscard]] Version inverted() const noexcept;

  /// The same samples with another position, spacing or units; width and height must agree.
  [[nodiscard]] Version withGrid(Grid grid) const;

  /// The edge lines, or null.
  [[nodiscard]] const EdgeLines& lines() const noexcept { return description_->lines; }
  /// The links between samples that the edge lines cut (line_cuts.h), or null without lines.
  [[nodiscard]] const LineCuts* lineCuts() const noexcept { return description_->cuts.get(); }
  /// The same samples with other edge lines, or with none. O(points). Throws std::bad_alloc.
  [[nodiscard]] Version withLines(EdgeLines lines) const;

  /// The form that is taken out of what is seen, felt and measured, or null. It is a layer: reader() and all that reads
  /// through it give the samples as they are, with the form; SeenField (seen_field.h) gives them without it.
  [[nodiscard]] const FieldForm& form() const noexcept { return description_->form; }
  /// The same samples under another form, or under none: no sample is touched. The form is of the field's width and
  /// height, its heights those of the upright field. Throws std::bad_alloc.
  [[nodiscard]] Version withForm(FieldForm form) const;
  /// Of what is seen under a form, edited or not: the version with the form, from which restored() (seen_field.h) makes
  /// the samples again; valid as long as this version. Null for every other version.
  [[nodiscard]] const Version* seenOf() const noexcept;
  /// Of the same what seenOf() is seen as, without an edit; else null.
  [[nodiscard]] const Version* seenAs() const noexcept;
  /// The same samples as seen of another version, or of none: then they are samples as any others. Throws std::bad_alloc.
  [[nodiscard]] Version withSeenOf(std::shared_ptr<const SeenPair> pair) const;
  /// The form under which this is stored: form(), of what is seen that of seenOf(), or null.
  [[nodiscard]] const FieldForm& formOver() const noexcept;

  /// Whether both are the same state (same tiles, same sign, same lines, same form), not only equal in content. O(1).
  friend bool operator==(const Version& a, const Version& b) noexcept {
    return a.root_ == b.root_ && a.sign_ == b.sign_ &&
           (a.empty() || (a.lines() == b.lines() && a.form() == b.form()));
  }

 private:
  friend class LiveField;
  friend class FieldBuilder;
  /// Takes over one reference to root.
  Version(std::shared_ptr<const FieldDescription> description, std::shared_ptr<FieldMemory> memory,
          Node* root, float sign) noexcept
      : description_(std::move(description)), memory_(std::move(memory)), root_(root), sign_(sign) {}

  [[nodiscard]] Version withDescription(FieldDescription description) const;

  std::shared_ptr<const FieldDescription> description_;
  std::shared_ptr<FieldMemory> memory_;  // destroyed after root_ was released
  Node* root_ = nullptr;
  float sign_ = 1.0F;
};

/// A version with a form, and the version without that is seen in its place.
struct SeenPair {
  Version restored;
  Version seen;  ///< seenOf() of it is null
};

inline const Version* Version::seenOf() const noexcept {
  return description_->seen_of ? &description_->seen_of->restored : nullptr;
}
inline const Version* Version::seenAs() const noexcept {
  return description_->seen_of ? &description_->seen_of->seen : nullptr;
}
inline const FieldForm& Version::formOver() const noexcept {
  return description_->seen_of ? description_->seen_of->restored.form() : form();
}

/// Summary of a field, in one pass over its tiles. Sums in double, tile by tile in a fixed order.
struct FieldSummary {
  std::int64_t no_data = 0;
  std::int64_t marked = 0;
  double min = 0.0, max = 0.0, mean = 0.0;  ///< [height_unit]; NaN when every sample is a hole
};
[[nodiscard]] FieldSummary summarize(const Version& version);

/// 64-bit hash over width, height, every sample's bits and every mark, row by row with the sign applied: the
/// same for equal content, however it is cut into versions. A hole counts as one fixed pattern. The mixing is
/// that of FNV-1a (Fowler, Noll, Vo) word by word. Distinguishes results in tests and reports; not secure
/// against an adversary.
[[nodiscard]] std::uint64_t contentHash(const Version& version);

}  // namespace fettle::engine
