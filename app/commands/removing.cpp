#include "app/commands/removing.h"

#include <utility>

#include "app/commands/typed_values.h"
#include "app/work/streams.h"
#include "engine/base/job.h"
#include "engine/field/piece.h"
#include "engine/marks/chosen_marks.h"

namespace fettle::app {

engine::Result<engine::RemoveOptions> removeOptionsOf(const RemoveArguments& arguments,
                                                      const engine::Grid& grid) {
  engine::RemoveOptions options;
  options.region = arguments.region.empty() ? engine::Region::kUnmarked : regionOf(arguments.region);
  const bool outside = !arguments.below.empty() || !arguments.above.empty();
  const bool between = !arguments.between.empty();
  if (outside && between)
    return engine::inputError("heights below or above limits and heights between limits exclude each other",
                              "--between", "remove one after the other");
  if (!outside && !between && arguments.region.empty())
    return engine::inputError("it is not said which samples go", "remove",
                              "add --below, --above, --between or --region marked");
  if (between && arguments.between.size() != 2)
    return engine::inputError("two heights are needed", "--between", "give LOW,HIGH, such as -0.5mm,20um");
  if (outside) options.heights = engine::RemoveOptions::Heights::kOutside;
  const auto read = [&](const std::string& typed, const char* option, double& limit) -> engine::Status {
    if (typed.empty()) return {};
    const auto height = parseSignedHeight(typed, grid, option);
    if (!height) return tl::unexpected(height.error());
    limit = *height;
    return {};
  };
  if (auto done = read(between ? arguments.between[0] : arguments.below, between ? "--between" : "--below",
                       options.low);
      !done)
    return tl::unexpected(done.error());
  if (auto done = read(between ? arguments.between[1] : arguments.above, between ? "--between" : "--above",
                       options.high);
      !done)
    return tl::unexpected(done.error());
  if (options.low > options.high)
    return outside ? engine::inputError("every height is below the one or above the other",
                                        "--below, --above", "swap them, or take --between")
                   : engine::inputError("the first height is above the second", "--between", "swap them");
  return options;
}

std::vector<Word> removeWords() {
  std::vector<Word> words{
      {"unmarked", "those that are not marked: a mark protects its sample"},
      {"marked", "marked samples alone, which nothing else removes; their marks go with them"},
      {"all", "marked or not"}};
  for (Word& shape : shapeWords()) {
    shape.text += shape.word == "rectangle" ? ", marked or not" : "";
    words.push_back(std::move(shape));
  }
  return words;
}

engine::Result<engine::Removed> removedFrom(const engine::Version& field, const engine::Version& counted,
                                            const std::string& region, const engine::RemoveOptions& options,
                                            const std::string& scan, engine::JobControl& job) {
  auto removed = engine::removeSamples(counted, options, job);
  if (!removed && removed.error().kind == engine::ErrorKind::kInput)
    return engine::inputError(removed.error().what, shownInput(scan), removed.error().remedy);
  if (!removed || !isShape(region)) return removed;
  // The marks of the shape were to choose.
  auto own = engine::withMarksFrom(removed->field, field, job);
  if (!own) return tl::unexpected(own.error());
  removed->field = *std::move(own);
  return removed;
}

PlannedOnPieces plannedRemove(const engine::Version& field, const engine::RemoveOptions& options) {
  // A session has what changed beside the original: much here and nothing there.
  return {.work = [&field, options](const engine::SampleRect& r,
                                    engine::JobControl& job) -> engine::Result<engine::Version> {
            engine::Version piece = engine::pieceOf(field, r.column, r.row, r.columns, r.rows);
            auto removed = engine::removeSamples(piece, options, job);
            if (removed) return std::move(removed->field);
            if (removed.error().kind == engine::ErrorKind::kInput)
              return piece;  // every sample of it would go
            return tl::unexpected(removed.error());
          },
          .uneven = true};
}

}  // namespace fettle::app
