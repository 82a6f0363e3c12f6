#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

using engine::RemoveOptions;

constexpr double kNoHeight = std::numeric_limits<double>::infinity();

// Which heights go.
enum class RemovedHeights : std::uint8_t { kAny, kBelow, kAbove, kBetween, kOutside };

RemovedHeights removedHeights(const RemoveOptions& remove) {
  const bool low = std::isfinite(remove.low), high = std::isfinite(remove.high);
  if (!low && !high) return RemovedHeights::kAny;
  if (remove.heights == RemoveOptions::Heights::kBetween) return RemovedHeights::kBetween;
  return low && high ? RemovedHeights::kOutside : low ? RemovedHeights::kBelow : RemovedHeights::kAbove;
}

void setHeights(RemoveOptions& remove, RemovedHeights heights, const render::ValueRange& seen) {
  remove.heights = heights == RemovedHeights::kAny || heights == RemovedHeights::kBetween
                       ? RemoveOptions::Heights::kBetween
                       : RemoveOptions::Heights::kOutside;
  const bool low = heights != RemovedHeights::kAny && heights != RemovedHeights::kAbove;
  const bool high = heights != RemovedHeights::kAny && heights != RemovedHeights::kBelow;
  if (!low) remove.low = -kNoHeight;
  if (!high) remove.high = kNoHeight;
  if (low && !std::isfinite(remove.low)) remove.low = seen.low;
  if (high && !std::isfinite(remove.high)) remove.high = seen.high;
  if (remove.low > remove.high) remove.low = seen.low, remove.high = seen.high;
}

// The ends of the colours where they are those of heights, else of the field.
render::ValueRange seenHeights(const PanelContext& context, const WindowPicture& picture) {
  const render::ValueRange& colours = picture.figures().range;
  if (ColourRange::quantityOf(picture.shown()) == render::Quantity::kHeight && colours.low < colours.high)
    return colours;
  const engine::HeightBounds bounds = context.client.field().reader().bounds();
  return bounds.empty() ? render::ValueRange{0.0, 1.0} : render::ValueRange{bounds.min, bounds.max};
}

void whichHeights(RemoveOptions& remove, const render::ValueRange& seen) {
  int chosen = static_cast<int>(removedHeights(remove));
  if (field("heights", "Samples lower, higher, between two heights or outside them.", [&] {
        return chooseWord("##removed heights", chosen,
                          {"any height", "below", "above", "between", "outside"});
      }))
    setHeights(remove, static_cast<RemovedHeights>(chosen), seen);
}

void limitFields(RemoveOptions& remove, const render::ShownUnit& unit) {
  const RemovedHeights heights = removedHeights(remove);
  const double width = remove.high - remove.low;
  const bool both = heights == RemovedHeights::kBetween || heights == RemovedHeights::kOutside;
  const bool below = heights == RemovedHeights::kBelow, above = heights == RemovedHeights::kAbove;
  // Past the other end: that one is moved along.
  if ((both || below) &&
      field(below ? textOf("lower than") : textOf("lowest"), "The lower limit, as a height of the field.",
            [&] { return typeLength("##remove low", remove.low, -1e30, 1e30, unit); }) &&
      both && remove.low > remove.high)
    remove.high = remove.low + width;
  if ((both || above) &&
      field(above ? textOf("higher than") : textOf("highest"), "The upper limit, as a height of the field.",
            [&] { return typeLength("##remove high", remove.high, -1e30, 1e30, unit); }) &&
      both && remove.low > remove.high)
    remove.low = remove.high - width;
}

void whichSamples(RemoveOptions& remove) {
  constexpr std::array<engine::Region, 3> kOf = {engine::Region::kUnmarked, engine::Region::kMarked,
                                                 engine::Region::kAll};
  (void)field("of",
              "Marked samples stay unless they are named here. What is removed loses its mark, so that its "
              "hole can be filled.",
              [&] {
                int of = 0;
                for (std::size_t i = 0; i < kOf.size(); ++i)
                  if (remove.region == kOf[i]) of = static_cast<int>(i);
                const bool changed = chooseWord("##removed of", of,
                                                {"samples not marked", "marked samples", "all, marked too"});
                if (changed) remove.region = kOf[static_cast<std::size_t>(of)];
                return changed;
              });
}

constexpr int kCountLines = 2;

std::string countText(const RemovalCount& count) {
  const auto& counts = count.counts();
  if (!counts) return tr("counting ...");
  if (counts->heights == 0) return tr("there is no sample with a height");
  if (counts->removed == counts->heights) return tr("all samples: nothing would be left");
  std::string text =
      counts->removed == 0
          ? std::string(tr("no sample would go"))
          : trFormat("{} of {} samples would go, {:.3g} %", counts->removed, counts->heights,
                     100.0 * static_cast<double>(counts->removed) / static_cast<double>(counts->heights));
  if (counts->spared > 0) text += trFormat("; {} stay since they are marked", counts->spared);
  return text;
}

}  // namespace

void removePanel(const PanelContext& context, HeightTool& heights, RemovalCount& count,
                 const WindowPicture& picture) {
  const bool turned = context.client.scene().invert;
  const render::ValueRange seen = seenHeights(context, picture);
  RemoveOptions remove = turned ? engine::upsideDown(heights.remove) : heights.remove;
  beginFields();
  whichSamples(remove);
  whichHeights(remove, seen);
  endFields();
  heights.remove = turned ? engine::upsideDown(remove) : remove;
  // Above the limits, which come and go with the word before: a button stays under the pointer.
  heightButtons(context, heights, heights.remove,
                {Action::kRemovePreview, Action::kRemoveSamples, textOf("Remove")});
  beginFields();
  limitFields(remove, context.units.height);
  endFields();
  if (const RemovedHeights kind = removedHeights(remove); kind != RemovedHeights::kAny) {
    if (pressButton(
            "Limits of the colours",
            "The ends of the colours as limits: in the panel Colours they are dragged on the histogram.")) {
      remove.low = -kNoHeight;
      remove.high = kNoHeight;
      setHeights(remove, kind, seen);
    }
  }
  heights.remove = turned ? engine::upsideDown(remove) : remove;
  count.want(heights.remove);
  // It takes one line or two.
  beginPlace("##remove count", kCountLines);
  writeWrapped(countText(count));
  endPlace();
  ImGui::PushID("removed");  // the place of the panel of holes has the same name
  heightOutcome(heights, heights.wasLast(heights.remove));
  ImGui::PopID();
}

}  // namespace fettle::app
