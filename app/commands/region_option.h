#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/commands/command.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/region.h"

namespace fettle::app {

/// The samples that count in a command: --region and --marks. Holes never do.
struct RegionArguments {
  /// As typed: a word of regionWords(), "rectangle X,Y,X,Y" or "polygon X,Y X,Y X,Y", in mm from the lower left sample, or both
  /// as "world-rectangle", "world-polygon", in the coordinates of the scan's world and its unit.
  std::string region = "all";
  std::string marks = {};  ///< a picture of marks instead of the scan's own; empty: none
  // The names of the options, for errors.
  std::string option = "--region", marks_option = "--marks";
};

/// The words that a region begins with, and what they mean: all of them, or shapes with coordinates alone.
[[nodiscard]] std::vector<Word> regionWords();
[[nodiscard]] std::vector<Word> shapeWords();

/// What is wrong with a region as typed, or an empty text: one that begins with none of `known`, no coordinates after a shape,
/// fewer than three corners, corners that enclose no area.
[[nodiscard]] std::string regionProblem(const std::string& typed, const std::vector<Word>& known);

/// The rows of both options, under their names. `text`: what the samples do.
void addRegionOptions(Command command, RegionArguments& arguments, const std::string& text,
                      const std::string& group = {}, const std::string& otherwise = {});
/// The row of the first alone, of commands that take other words.
[[nodiscard]] Parameter regionRow(RegionArguments& arguments, const std::string& text,
                                  const std::string& otherwise, std::vector<Word> words);

/// Refuses marks where the region is not one of marked or unmarked samples (kInput).
[[nodiscard]] engine::Status checkRegion(const RegionArguments& arguments);

/// Whether marks choose: those of --marks or of the scan.
[[nodiscard]] bool choosesByMarks(const std::string& region) noexcept;
/// Whether it is a shape with coordinates.
[[nodiscard]] bool isShape(const std::string& region) noexcept;

/// What a region means in the field that countedOf() makes. That of a shape is marked there, and nothing else.
[[nodiscard]] engine::Region regionOf(const std::string& region) noexcept;

/// The field that is measured: with the marks of the arguments, or in the region "measured" with holes in place of the
/// samples that were filled since `original`, that of a session, or with the samples inside a shape marked. `scan` is its
/// path. A rectangle has the samples on its sides, but for rounding; of a polygon those on lower and left sides (engine::Polygon).
///
/// Errors: as withMarks; (kInput) the region "measured" without an original, or of filled samples alone; marked samples where none
/// with a height is marked, unmarked ones where all are; a shape that no sample lies in, or holes alone; a polygon with a corner
/// 2^20 samples away. A field of holes alone has no region that is too small: whoever measures it says so.
[[nodiscard]] engine::Result<engine::Version> countedOf(const engine::Version& field,
                                                        const std::optional<engine::Version>& original,
                                                        const std::string& scan,
                                                        const RegionArguments& arguments,
                                                        engine::JobControl& job);

/// As countedOf, where a region of marks may have no sample: there nothing is done (removal).
[[nodiscard]] engine::Result<engine::Version> countedOrNone(const engine::Version& field,
                                                            const std::optional<engine::Version>& original,
                                                            const std::string& scan,
                                                            const RegionArguments& arguments,
                                                            engine::JobControl& job);

/// The field with holes wherever samples do not count. Errors: as countedOf.
[[nodiscard]] engine::Result<engine::Version> chosenOf(const engine::Version& field,
                                                       const std::optional<engine::Version>& original,
                                                       const std::string& scan,
                                                       const RegionArguments& arguments,
                                                       engine::JobControl& job);

/// Warns where samples of a session that count were filled, not measured.
void warnOfFilled(const engine::Version& counted, const std::optional<engine::Version>& original,
                  const std::string& scan);

/// Warns where samples were filled and the file of `out`, of the extension `to` on standard output, will not say which: all
/// but sessions. Memory (memoryPlace) does.
void warnOfFilledLost(const engine::Version& field, const std::optional<engine::Version>& original,
                      const std::string& out, const std::string& to);

/// Another field at the samples of `chosen`, what chosenOf() made of `field`: with holes wherever that has some, but of all
/// samples as it is. A field of other sides is returned as it is.
[[nodiscard]] engine::Result<engine::Version> chosenLike(const engine::Version& other,
                                                         const engine::Version& chosen,
                                                         const RegionArguments& arguments,
                                                         engine::JobControl& job);

}  // namespace fettle::app
