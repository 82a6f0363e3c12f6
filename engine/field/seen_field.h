#pragma once

#include <utility>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// A version with a form over it, and the field that is seen, felt and measured in its place: height - form, rounded to
/// float once. Holes, marks, edge lines and sign are the same in both. A version without a form is seen as it is, and costs
/// nothing here.
///
/// The samples of the version are never computed from those that are seen, but for the samples that were edited there:
///
///   edited()   a seen sample that is still what its sample is seen as: the sample keeps its bits
///              any other: seen + form, rounded to float once; a hole where a hole is seen
///
/// So a form goes in and out exactly, however often, and an edit is within half a unit in the last place of what was
/// seen, restored; a limit of changes holds to the rounding of both. Editing again what was edited, or another sample, changes no sample a second time. A difference
/// beyond the range of float becomes the largest float.
///
/// Tiles that versions share are shared by what is seen of them. Thread: any; of() and at() of another form are long
/// jobs on all workers of the calling arena, edited() and at() of the same form take time proportional to the tiles in
/// which the versions differ. Bit-identical for any number of threads.
class SeenField {
 public:
  /// Empty; may only be assigned to.
  SeenField() = default;

  /// Errors: kFailed without memory; kCancelled.
  [[nodiscard]] static Result<SeenField> of(const Version& version, JobControl& job);

  /// With the form: the version as it is stored.
  [[nodiscard]] const Version& restored() const noexcept { return restored_; }
  /// Without the form; Version::form() of it is null, Version::seenOf() is restored(). A function of restored() alone.
  [[nodiscard]] const Version& seen() const noexcept { return seen_; }

  /// After edits: `field` is a later state of seen(), or of the field that the last edited() was given, with any
  /// samples, marks and lines changed; its sign is taken over. Errors: as of().
  [[nodiscard]] Result<SeenField> edited(const Version& field, JobControl& job) const;

  /// The same for another state of restored(): of(version), with all tiles shared that the two have in common.
  [[nodiscard]] Result<SeenField> at(const Version& version, JobControl& job) const;

 private:
  friend Result<Version> seenNear(const Version& version, const Version& near, JobControl& job);
  SeenField(Version restored, Version seen, Version field) noexcept
      : restored_(std::move(restored)), seen_(std::move(seen)), field_(std::move(field)) {}

  Version restored_;
  Version seen_;
  Version field_;  // last given to edited(), else seen_: its tiles have been taken back
};

/// What is stored of a field: of one that is seen under a form, edited or not, the version with the form, edits taken
/// back as by SeenField::edited(); any other field itself. A function of the field and of Version::seenOf() alone, tile by
/// tile: it is the same whatever was done and undone before. It has the field's grid. Time proportional to the tiles that
/// differ from Version::seenAs(). Errors and thread as SeenField::of().
[[nodiscard]] Result<Version> restored(const Version& field, JobControl& job);

/// restored() of one state of a field after the other, with all tiles shared that the states share, in time proportional
/// to the tiles in which a state differs from the one before it. A state without a form costs nothing.
/// Thread: one at a time.
class StoredStates {
 public:
  [[nodiscard]] Result<Version> of(const Version& state, JobControl& job);

 private:
  Version state_, stored_;  // the last one under a form
};

/// What is seen of a version, as by SeenField::of(), sharing all tiles with `near` that it can: any field, best one that is
/// seen under the same form; then the time is proportional to the tiles in which the version differs from near's
/// Version::seenOf(). A version without a form is seen as it is. Errors and thread as SeenField::of().
[[nodiscard]] Result<Version> seenNear(const Version& version, const Version& near, JobControl& job);

/// What is seen of a field as samples like any others, with no form over them. Throws std::bad_alloc.
[[nodiscard]] Version madeHeights(const Version& field);

/// `version` with the tiles of `with`, of the same size and memory, where they have the same bits: time proportional to
/// the tiles that the two do not share. Errors: kFailed without memory. Thread: any.
[[nodiscard]] Result<Version> sharingEqualTiles(const Version& version, const Version& with);

/// The form under which a field is stored, upside down where the field is: that of the heights which its reader() gives.
/// Null without a form. Throws std::bad_alloc.
[[nodiscard]] FieldForm formOfHeights(const Version& field);

/// restored() without any form over it: the samples as they are.
[[nodiscard]] Result<Version> withoutLayer(const Version& field, JobControl& job);

/// A field as it is seen under the form that another field is seen under, so that both can be compared; its samples where
/// that is seen under none, or has another size. Errors and thread as SeenField::of().
[[nodiscard]] Result<Version> seenLike(const Version& field, const Version& other, JobControl& job);

}  // namespace fettle::engine
