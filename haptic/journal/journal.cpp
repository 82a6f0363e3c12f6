#include "haptic/journal/journal.h"

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/filter/catalogue.h"

namespace fettle::haptic {
namespace {

using nlohmann::json;

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

constexpr std::array<std::string_view, 2> kScopes = {"keep", "only"};

template <std::size_t N>
std::size_t wordOf(const json& value, const std::array<std::string_view, N>& words) {
  const auto& text = value.get_ref<const std::string&>();
  for (std::size_t i = 0; i < N; ++i)
    if (text == words[i]) return i;
  throw std::out_of_range(fmt::format("\"{}\" is none of {}", text, fmt::join(words, ", ")));
}

void put(json& out, const LoopPlace& at) {
  out["tick"] = at.tick;
  if (at.answered) out["answered"] = true;
}

LoopPlace placeOf(const json& in) {
  return {in.at("tick").get<std::uint64_t>(), in.value("answered", false)};
}

void put(json& out, const engine::FilterSpec& spec) {
  out["filter"] = engine::name(spec.kind);
  out["window"] = spec.window;
  if (spec.sigma > 0.0) out["sigma"] = spec.sigma;
  if (spec.range_sigma > 0.0) out["range_sigma"] = spec.range_sigma;
  if (spec.nesting_mm > 0.0) out["nesting_mm"] = spec.nesting_mm;
  if (engine::filterOf(spec.kind).has_element)
    out["element"] = engine::kElementWords[static_cast<std::size_t>(spec.element)];
  out["passes"] = spec.passes;
  out["marks"] = kScopes[static_cast<std::size_t>(spec.scope)];
  if (spec.max_change) out["max_change"] = *spec.max_change;
}

engine::FilterSpec specOf(const json& in) {
  engine::FilterSpec spec;
  const auto& word = in.at("filter").get_ref<const std::string&>();
  const engine::Filter* filter = engine::filterNamed(word);
  if (filter == nullptr) throw std::out_of_range(fmt::format("\"{}\" is no filter", word));
  spec.kind = filter->kind;
  spec.window = in.at("window").get<int>();
  spec.sigma = in.value("sigma", 0.0);
  spec.range_sigma = in.value("range_sigma", 0.0);
  spec.nesting_mm = in.value("nesting_mm", 0.0);
  if (in.contains("element"))
    spec.element = static_cast<engine::Element>(wordOf(in.at("element"), engine::kElementWords));
  spec.passes = in.at("passes").get<int>();
  spec.scope = static_cast<engine::FilterScope>(wordOf(in.at("marks"), kScopes));
  if (in.contains("max_change")) spec.max_change = in.at("max_change").get<double>();
  return spec;
}

void put(json& out, const Scene& scene) {
  out["scene"] = sceneText(scene);
  out["contact"] = kContactRevision;
}

haptic::Scene sceneOf(const json& in) {
  auto scene =
      haptic::parseScene(in.at("scene").get_ref<const std::string&>(), "scene", in.value("contact", 1));
  if (!scene) throw std::out_of_range(scene.error().line());
  return *std::move(scene);
}

std::optional<journal::EdgesSuggested> suggestedOf(const json& in) {
  const auto found = in.find("suggested");
  if (found == in.end()) return std::nullopt;
  return journal::EdgesSuggested{found->at("scale").get<double>(), found->at("sensitivity").get<double>(),
                                 found->at("thickness").get<double>()};
}

// Three points of a plane, and the radius around each where one was said.
std::optional<engine::ThreePoints> throughOf(const json& in) {
  const auto found = in.find("through");
  if (found == in.end()) return std::nullopt;
  engine::ThreePoints points;
  for (std::size_t k = 0; k < points.at_mm.size(); ++k)
    points.at_mm[k] = {found->at(k).at(0).get<double>(), found->at(k).at(1).get<double>()};
  points.radius_mm = in.value("probe_mm", 0.0);
  return points;
}

void put(json& out, const engine::ThreePoints& points) {
  for (const glm::dvec2& at : points.at_mm) out["through"].push_back({at.x, at.y});
  if (points.radius_mm > 0.0) out["probe_mm"] = points.radius_mm;
}

std::optional<journal::FormFitted> fittedOf(const json& in) {
  const auto found = in.find("fitted");
  if (found == in.end()) return std::nullopt;
  return journal::FormFitted{found->at("form").get<std::string>(), found->at("region").get<std::string>(),
                             found->at("robust").get<bool>(), throughOf(*found)};
}

constexpr std::array<std::string_view, 2> kFillMethods = {"membrane", "curvature"};
constexpr std::array<std::string_view, 4> kLineMethods = {"median", "polynomial", "difference", "matching"};
constexpr std::array<std::string_view, 2> kScanAxes = {"x", "y"};
constexpr std::array<std::string_view, 2> kRemovedHeights = {"between", "outside"};
constexpr std::array<std::string_view, 3> kRegions = {"all", "marked", "unmarked"};

// Limits that are infinite are left out.
json jsonOf(const engine::FillOptions& fill) {
  json out = {{"fill", kFillMethods[static_cast<std::size_t>(fill.method)]}, {"border", fill.at_border}};
  if (std::isfinite(fill.most_extent_mm)) out["most_extent_mm"] = fill.most_extent_mm;
  if (std::isfinite(fill.most_area_mm2)) out["most_area_mm2"] = fill.most_area_mm2;
  return out;
}
json jsonOf(const engine::LineOptions& lines) {
  json out = {{"lines", kLineMethods[static_cast<std::size_t>(lines.method)]},
              {"degree", lines.degree},
              {"axis", kScanAxes[static_cast<std::size_t>(lines.axis)]},
              {"region", engine::wordOf(lines.region)},
              {"robust", lines.robust}};
  if (lines.form_degree) out["form_degree"] = *lines.form_degree;
  return out;
}

json jsonOf(const engine::RemoveOptions& remove) {
  json out = {{"remove", kRemovedHeights[static_cast<std::size_t>(remove.heights)]},
              {"region", engine::wordOf(remove.region)}};
  if (std::isfinite(remove.low)) out["low"] = remove.low;
  if (std::isfinite(remove.high)) out["high"] = remove.high;
  return out;
}

HeightsMaker makerOf(const json& in) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  if (in.contains("fill"))
    return engine::FillOptions{.method = static_cast<engine::FillMethod>(wordOf(in.at("fill"), kFillMethods)),
                               .most_extent_mm = in.value("most_extent_mm", kAny),
                               .most_area_mm2 = in.value("most_area_mm2", kAny),
                               .at_border = in.at("border").get<bool>()};
  if (in.contains("remove"))
    return engine::RemoveOptions{
        .heights = static_cast<engine::RemoveOptions::Heights>(wordOf(in.at("remove"), kRemovedHeights)),
        .low = in.value("low", -kAny),
        .high = in.value("high", kAny),
        .region = static_cast<engine::Region>(wordOf(in.at("region"), kRegions))};
  engine::LineOptions lines{.method = static_cast<engine::LineMethod>(wordOf(in.at("lines"), kLineMethods)),
                            .degree = in.at("degree").get<int>(),
                            .axis = static_cast<engine::ScanAxis>(wordOf(in.at("axis"), kScanAxes)),
                            .region = static_cast<engine::Region>(wordOf(in.at("region"), kRegions)),
                            .robust = in.at("robust").get<bool>()};
  if (const auto form = in.find("form_degree"); form != in.end()) lines.form_degree = form->get<int>();
  return lines;
}

journal::Entry entryOf(const json& in) {
  const auto& what = in.at("do").get_ref<const std::string&>();
  const auto id = [&] { return in.at("id").get<std::uint64_t>(); };
  const auto state = [&] { return in.at("state").get<std::int64_t>(); };
  const auto count = [&] { return in.at("count").get<std::int64_t>(); };
  if (what == "begin") return journal::Begin{state(), sceneOf(in), in.value("continues", false)};
  if (what == "read") return journal::StateRead{state()};
  if (what == "ticks") return journal::Ticks{count()};
  if (what == "lost") return journal::Lost{count()};
  if (what == "scene") return journal::SceneSet{placeOf(in), sceneOf(in)};
  if (what == "step") {
    const auto kind = engine::stepKindFromName(in.at("kind").get_ref<const std::string&>());
    if (!kind) throw std::out_of_range("an unknown kind of step");
    return journal::StepMade{state(),         in.at("name").get<std::string>(), *kind,
                             placeOf(in),     in.value("marks", false),         in.value("lines", false),
                             suggestedOf(in), in.value("form", false),          in.value("heights", false),
                             fittedOf(in)};
  }
  if (what == "computed") {
    journal::StepMade step{state(), in.at("name").get<std::string>(), engine::StepKind::kFilter, placeOf(in)};
    step.maker = makerOf(in.at("by"));
    return step;
  }
  if (what == "restore") return journal::RestoreRequested{id(), state()};
  if (what == "restored") return journal::Restored{id(), placeOf(in)};
  if (what == "base") return journal::FilterBase{id(), placeOf(in)};
  if (what == "filter") return journal::FilterBegun{id(), specOf(in)};
  if (what == "snapshot") return journal::Snapshot{placeOf(in)};
  if (what == "offered") return journal::Offered{placeOf(in), in.at("taken").get<bool>()};
  throw std::out_of_range(fmt::format("unknown action \"{}\"", what));
}

}  // namespace

std::string journalText(const journal::Entry& entry) {
  json out;
  std::visit(
      Overloaded{
          [&](const journal::Begin& e) {
            out = {{"do", "begin"}, {"state", e.state}};
            if (e.continues) out["continues"] = true;
            put(out, e.scene);
          },
          [&](const journal::StateRead& e) {
            out = {{"do", "read"}, {"state", e.state}};
          },
          [&](const journal::Ticks& e) {
            out = {{"do", "ticks"}, {"count", e.count}};
          },
          [&](const journal::Lost& e) {
            out = {{"do", "lost"}, {"count", e.count}};
          },
          [&](const journal::SceneSet& e) {
            out = {{"do", "scene"}};
            put(out, e.scene);
            put(out, e.at);
          },
          [&](const journal::StepMade& e) {
            if (e.maker) {
              out = {{"do", "computed"}, {"state", e.state}, {"name", e.name}};
              out["by"] = std::visit([](const auto& by) { return jsonOf(by); }, *e.maker);
              put(out, e.at);
              return;
            }
            out = {
                {"do", "step"}, {"state", e.state}, {"name", e.name}, {"kind", engine::stepKindName(e.kind)}};
            if (e.marks) out["marks"] = true;
            if (e.lines) out["lines"] = true;
            if (e.form) out["form"] = true;
            if (e.heights) out["heights"] = true;
            if (e.suggested)
              out["suggested"] = {{"scale", e.suggested->scale},
                                  {"sensitivity", e.suggested->sensitivity},
                                  {"thickness", e.suggested->thickness}};
            if (e.fitted)
              out["fitted"] = {
                  {"form", e.fitted->form}, {"region", e.fitted->region}, {"robust", e.fitted->robust}};
            if (e.fitted && e.fitted->through) put(out["fitted"], *e.fitted->through);
            put(out, e.at);
          },
          [&](const journal::RestoreRequested& e) {
            out = {{"do", "restore"}, {"id", e.id}, {"state", e.state}};
          },
          [&](const journal::Restored& e) {
            out = {{"do", "restored"}, {"id", e.id}};
            put(out, e.at);
          },
          [&](const journal::FilterBase& e) {
            out = {{"do", "base"}, {"id", e.id}};
            put(out, e.at);
          },
          [&](const journal::FilterBegun& e) {
            out = {{"do", "filter"}, {"id", e.id}};
            put(out, e.spec);
          },
          [&](const journal::Snapshot& e) {
            out = {{"do", "snapshot"}};
            put(out, e.at);
          },
          [&](const journal::Offered& e) {
            out = {{"do", "offered"}, {"taken", e.taken}};
            put(out, e.at);
          },
      },
      entry);
  return out.dump();
}

engine::Result<journal::Entry> journalEntry(const std::string& text) try {
  return entryOf(json::parse(text));
} catch (const json::exception& error) {
  return engine::inputError(fmt::format("a journal entry that cannot be read: {}", error.what()), "journal");
} catch (const std::out_of_range& error) {
  return engine::inputError(fmt::format("a journal entry that cannot be read: {}", error.what()), "journal");
}

}  // namespace fettle::haptic
