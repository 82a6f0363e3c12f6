#include "app/work/areal_table.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "app/texts/texts.h"
#include "app/work/estimate_text.h"
#include "app/work/read_units.h"
#include "engine/uncertainty/areal_figures.h"

namespace fettle::app {

namespace {

// What a number is: its unit, and how a person reads it.
enum class Quantity : std::uint8_t {
  kHeight,
  kVolume,
  kRatio,
  kPlain,
  kDegrees,
  kLength,
  kPerArea,
  kPerLength,
  kArea,
  kBulk  // of a hill: area times height
};

struct ArealRow {
  const char* group;
  const char* key;
  const char* name;
  Quantity quantity;
  const char* text;
};
constexpr ArealRow kArealRows[] = {
    {"height", "sq", "Sq", Quantity::kHeight, textOf("root mean square height")},
    {"height", "ssk", "Ssk", Quantity::kPlain, textOf("skewness")},
    {"height", "sku", "Sku", Quantity::kPlain, textOf("kurtosis")},
    {"height", "sp", "Sp", Quantity::kHeight, textOf("maximum peak height")},
    {"height", "sv", "Sv", Quantity::kHeight, textOf("maximum pit depth")},
    {"height", "sz", "Sz", Quantity::kHeight, textOf("maximum height")},
    {"height", "sa", "Sa", Quantity::kHeight, textOf("arithmetical mean height")},
    {"spatial", "sal", "Sal", Quantity::kLength, textOf("autocorrelation length (to 0.2)")},
    {"spatial", "str", "Str", Quantity::kPlain, textOf("texture aspect ratio (to 0.2)")},
    {"spatial", "std", "Std", Quantity::kDegrees, textOf("texture direction: of the lay, from x to y")},
    {"spatial", "ssw", "Ssw", Quantity::kLength, textOf("dominant spatial wavelength")},
    {"hybrid", "sdq", "Sdq", Quantity::kPlain, textOf("root mean square gradient")},
    {"hybrid", "sdr", "Sdr", Quantity::kRatio, textOf("developed interfacial area ratio")},
    {"functional", "sk", "Sk", Quantity::kHeight, textOf("core height")},
    {"functional", "spk", "Spk", Quantity::kHeight, textOf("reduced peak height")},
    {"functional", "svk", "Svk", Quantity::kHeight, textOf("reduced dale height")},
    {"functional", "smrk1", "Smrk1", Quantity::kRatio, textOf("material ratio of the peaks (Smr1)")},
    {"functional", "smrk2", "Smrk2", Quantity::kRatio, textOf("material ratio above the dales (Smr2)")},
    {"functional", "vmp", "Vmp", Quantity::kVolume, textOf("material volume of the peaks (10 %)")},
    {"functional", "vmc", "Vmc", Quantity::kVolume, textOf("material volume of the core (10 to 80 %)")},
    {"functional", "vvc", "Vvc", Quantity::kVolume, textOf("void volume of the core (10 to 80 %)")},
    {"functional", "vvv", "Vvv", Quantity::kVolume, textOf("void volume of the dales (80 %)")},
    {"functional", "sxp", "Sxp", Quantity::kHeight, textOf("peak extreme height (2.5 to 50 %)")},
    {"feature", "spd", "Spd", Quantity::kPerArea, textOf("density of peaks (hills of 5 % of Sz and more)")},
    {"feature", "svd", "Svd", Quantity::kPerArea, textOf("density of pits (dales of 5 % of Sz and more)")},
    {"feature", "spc", "Spc", Quantity::kPerLength, textOf("arithmetic mean peak curvature")},
    {"feature", "svc", "Svc", Quantity::kPerLength, textOf("arithmetic mean pit curvature")},
    {"feature", "s5p", "S5p", Quantity::kHeight, textOf("five-point peak height")},
    {"feature", "s5v", "S5v", Quantity::kHeight, textOf("five-point pit depth")},
    {"feature", "s10z", "S10z", Quantity::kHeight, textOf("ten-point height (S5p + S5v)")},
    {"feature", "sha", "Sha", Quantity::kArea, textOf("mean hill area (of closed hills)")},
    {"feature", "sda", "Sda", Quantity::kArea, textOf("mean dale area (of closed dales)")},
    {"feature", "shv", "Shv", Quantity::kBulk, textOf("mean hill volume (above the highest saddle)")},
    {"feature", "sdv", "Sdv", Quantity::kBulk, textOf("mean dale volume (below the lowest saddle)")},
};

constexpr ArealGroup kArealGroups[] = {
    {"height", "Height", "Sq Ssk Sku Sp Sv Sz Sa"},
    {"spatial", "Spatial", "Sal Str Std Ssw"},
    {"hybrid", "Hybrid", "Sdq Sdr"},
    {"functional", "Functional", "Sk Spk Svk Smrk1 Smrk2 Vmp Vmc Vvc Vvv Sxp, Smr(c) and Smc(mr)"},
    {"feature", "Feature", "Spd Svd Spc Svc S5p S5v S10z Sha Sda Shv Sdv"},
};

// Of the root mean square height. The scan's where there is none.
ReadAs unitOfSq(const Report& report) {
  const Report& sq = report["sq"];
  return readLengthAs(sq.is_null() ? 0.0 : sq.get<double>(), report["unit_mm"], report["unit"]);
}

// Whether a number has no exponent with the five digits that rows have, and at most two zeros behind its point.
bool isReadable(double shown) {
  return shown >= 1e-3 && shown < 99999.5;
}

// One unit for all rows of heights, of volumes, which are heights too, and for these of all reports: of those in which the most are
// readable, `usual` or the nearest to it. Single spikes make Sz thousands of times Sq, and of what a filter leaves Vmp is some
// hundredths of it.
ReadAs readHeightsAs(std::span<const Report> reports, const ReadAs& usual) {
  const double unit_mm = reports.front()["unit_mm"];
  const std::string unit = reports.front()["unit"];
  std::vector<double> heights;
  for (const Report& report : reports) {
    const auto take = [&heights](const Report& height) {
      if (!height.is_null() && height.get<double>() != 0.0) heights.push_back(std::abs(height.get<double>()));
    };
    for (const ArealRow& row : kArealRows)
      if ((row.quantity == Quantity::kHeight || row.quantity == Quantity::kVolume) &&
          report.contains(row.key))
        take(report[row.key]);
    if (report.contains("sdc")) take(report["sdc"]["height"]);
  }
  const auto readable = [&heights](const ReadAs& as) {
    return std::ranges::count_if(heights, [&as](double height) { return isReadable(height / as.size); });
  };
  const auto away = [&usual](const ReadAs& as) { return std::abs(std::log(as.size / usual.size)); };
  ReadAs best = usual;
  for (const double mm : {1e3, 1.0, 1e-3, 1e-6}) {
    const ReadAs other = readLengthAs(1.5 * mm / unit_mm, unit_mm, unit);
    const auto more = readable(other) - readable(best);
    if (more > 0 || (more == 0 && away(other) < away(best))) best = other;
  }
  return best;
}

struct Shown {
  double factor;
  std::string unit;
};
Shown shownAs(Quantity quantity, const ReadAs& height, const ReadAs& length) {
  switch (quantity) {
    case Quantity::kHeight:
      return {1.0 / height.size, height.name};
    case Quantity::kVolume:
      return {1.0 / height.size, fmt::format("{0}3/{0}2", height.name)};
    case Quantity::kRatio:
      return {100.0, "%"};
    case Quantity::kPlain:
      return {1.0, ""};
    case Quantity::kDegrees:
      return {1.0, "degrees"};
    case Quantity::kLength:
      return {1.0 / length.size, length.name};
    case Quantity::kPerArea:
      return {length.size * length.size, fmt::format("1/{}2", length.name)};
    case Quantity::kPerLength:
      return {length.size, fmt::format("1/{}", length.name)};
    case Quantity::kArea:
      return {1.0 / (length.size * length.size), fmt::format("{}2", length.name)};
    case Quantity::kBulk:
      return {1.0 / (length.size * length.size * height.size),
              height.name == length.name ? fmt::format("{}3", length.name)
                                         : fmt::format("{}2 {}", length.name, height.name)};
  }
  return {1.0, ""};
}

// A figure as measured, in millimetres and squares of them, in units of the scan.
double inScanUnits(double value, Quantity quantity, const engine::Grid& grid) {
  const double lateral_mm = grid.lateral_unit.mm;
  switch (quantity) {
    case Quantity::kLength:
      return value / lateral_mm;
    case Quantity::kPerArea:
      return value * lateral_mm * lateral_mm;
    case Quantity::kPerLength:
      return value * lateral_mm;
    case Quantity::kArea:
      return value / (lateral_mm * lateral_mm);
    case Quantity::kBulk:
      return value / (lateral_mm * lateral_mm * grid.height_unit.mm);
    default:
      return value;
  }
}

bool wanted(const char* group, const std::vector<std::string>& groups) {
  // Those of height are measured in any case.
  return groups.empty() || std::string_view(group) == "height" ||
         std::ranges::find(groups, group) != groups.end();
}

std::string reasonOf(const Report& report, std::string_view key) {
  for (const Report& each : report["not_stated"])
    if (each["parameter"].get<std::string>() == key) return each["reason"].get<std::string>();
  return "";
}

// A figure as text that was rounded: of a direction 180 degrees are 0.
std::string inHalfTurn(std::string rounded, Quantity quantity) {
  if (quantity == Quantity::kDegrees && std::stod(rounded) == 180.0) return "0";
  return rounded;
}

// "12.3 +- 0.2": a figure without noise, of an object with `without` and `error`; empty where these are not stated.
std::string withoutNoise(const Report& effect, double factor, Quantity quantity) {
  if (effect.is_null() || effect["without"].is_null()) return "";
  const double without = effect["without"].get<double>() * factor,
               error = effect["error"].get<double>() * factor;
  return fmt::format("{} +- {:.2g}", inHalfTurn(shownTo(without, error), quantity), error);
}

// The text of a row with the ratios and the pruning of a report in place of the usual ones.
std::string textWith(const ArealRow& row, const Report& report) {
  std::string text = row.text;
  const auto put = [&text](const std::string& usual, const std::string& own) {
    if (const std::size_t at = text.find(usual); at != std::string::npos) text.replace(at, usual.size(), own);
  };
  if (row.quantity == Quantity::kVolume && report.contains("volume_ratios")) {
    const double p = 100.0 * report["volume_ratios"][0].get<double>(),
                 q = 100.0 * report["volume_ratios"][1].get<double>();
    put("(10 to 80 %)", fmt::format("({:.6g} to {:.6g} %)", p, q));
    put("(10 %)", fmt::format("({:.6g} %)", p));
    put("(80 %)", fmt::format("({:.6g} %)", q));
  }
  if (report.contains("prune"))
    put("of 5 % of Sz", fmt::format("of {:.6g} % of Sz", 100.0 * report["prune"].get<double>()));
  return text;
}

constexpr const char* kSdcText = textOf("height difference of two material ratios");

std::string sdcText(const Report& sdc) {
  return fmt::format("height difference of the material ratios {:.5g} and {:.5g} %",
                     sdc["ratios"][0].get<double>() * 100.0, sdc["ratios"][1].get<double>() * 100.0);
}

bool isFunctional(const ArealGroup& group) {
  return std::string_view(group.word) == "functional";
}

// Why a figure without noise is not stated.
std::string noWithout(const Report& effect) {
  return effect.is_null() ? "" : effect.value("reason", std::string());
}

void printRow(const std::string& name, const Report& value, Quantity quantity, const Shown& shown,
              const std::string& text, const Report& effect, bool noise) {
  if (value.is_null()) return;  // with all others: the reason stands with these
  const std::string without = withoutNoise(effect, shown.factor, quantity);
  const std::string why = noWithout(effect);
  fmt::print("{:<8} {:>12} {:<10} {}{}{}\n", name,
             inHalfTurn(fmt::format("{:.5g}", value.get<double>() * shown.factor), quantity), shown.unit,
             noise ? fmt::format("{:>22}  ", without.empty() ? "-" : without) : "", text,
             why.empty() ? "" : fmt::format(" (-: {})", why));
}

std::string withoutRemark(const Report& effect) {
  const std::string why = noWithout(effect);
  return why.empty() ? why : "without noise not stated: " + why;
}

// What the noise does to a volume of `smc`, as of the height itself; null where that is not known.
Report effectOnVolume(const Report& each, const std::string& key) {
  if (!each.contains(key + "_without")) return {};
  return {{"without", each[key + "_without"]},
          {"error", each[key + "_error"]},
          {"reason", each[key + "_reason"]}};
}

// What the noise does to a parameter; null where that is not known.
Report effectOn(const Report& report, std::string_view key) {
  if (!report.contains("noise")) return {};
  for (const Report& each : report["noise"]["figures"])
    if (each["parameter"].get<std::string>() == key) return each;
  return {};
}

// A field of a CSV, quoted where it must be: RFC 4180.
std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string field = "\"";
  for (const char c : text) {
    if (c == '"') field += '"';
    field += c;
  }
  return field + '"';
}

}  // namespace

std::span<const ArealGroup> arealGroups() noexcept {
  return kArealGroups;
}

void addAreal(Report& report, const engine::ArealParameters& measured, const std::vector<std::string>& groups,
              const engine::Grid& grid) {
  report["unit"] = grid.height_unit.name;
  report["unit_mm"] = grid.height_unit.mm;
  report["lateral_unit"] = grid.lateral_unit.name;
  report["lateral_unit_mm"] = grid.lateral_unit.mm;
  report["spacing"] = std::max(grid.spacing_x, grid.spacing_y);
  report["samples"] = measured.samples;
  report["mean"] = measured.mean;
  for (const ArealRow& row : kArealRows) {
    if (!wanted(row.group, groups)) continue;
    const double value = inScanUnits(engine::arealFigure(row.key).of(measured), row.quantity, grid);
    report[row.key] = std::isfinite(value) ? Report(value) : Report();
  }
  if (wanted("hybrid", groups)) report["cells"] = measured.cells;
  if (wanted("feature", groups)) {
    report["hills"] = measured.feature.hills;
    report["dales"] = measured.feature.dales;
  }
  report["not_stated"] = Report::array();
  for (const auto& each : measured.not_stated)
    if (report.contains(each.parameter))
      report["not_stated"].push_back({{"parameter", each.parameter}, {"reason", each.reason}});
}

void addNoise(Report& report, const ArealNoise& noise, const engine::Grid& grid) {
  const auto number = [](double value) { return std::isfinite(value) ? Report(value) : Report(); };
  report["noise"] = {{"sigma", number(noise.sigma)},
                     {"trials", noise.trials},
                     {"error_of_errors", engine::errorOfErrors(noise.trials / 2)},
                     {"figures", Report::array()}};
  const auto figures = engine::arealFigures();
  for (const ArealRow& row : kArealRows) {
    if (!report.contains(row.key)) continue;
    for (std::size_t i = 0; i < figures.size(); ++i)
      if (figures[i].key == row.key)
        report["noise"]["figures"].push_back(
            {{"parameter", row.key},
             {"without", number(inScanUnits(noise.effects[i].without, row.quantity, grid))},
             {"error", number(inScanUnits(noise.effects[i].error, row.quantity, grid))},
             // What is not stated with noise is not stated without, for the same reason.
             {"reason",
              report[row.key].is_null() ? reasonOf(report, row.key) : std::string(noise.effects[i].why)}});
  }
  // What was asked for comes after all parameters (engine::valuesOf), volumes with the keys of `smc` before theirs.
  std::size_t next = figures.size();
  const auto put = [&](Report& to, const std::string& before) {
    to[before + "without"] = number(noise.effects[next].without);
    to[before + "error"] = number(noise.effects[next].error);
    to[before + "reason"] = noise.effects[next].why;
    ++next;
  };
  for (const auto& [list, before] :
       {std::pair("smr", ""), {"smc", ""}, {"smc", "material_volume_"}, {"smc", "void_volume_"}})
    if (report.contains(list))
      for (Report& each : report[list]) put(each, before);
  if (report.contains("sdc")) put(report["sdc"], "");
}

void printAreal(const Report& report) {
  const ReadAs height = readHeightsAs({&report, 1}, unitOfSq(report));
  const ReadAs length = readAcrossAs(report["spacing"], report["lateral_unit_mm"], report["lateral_unit"]);
  const bool noise = report.contains("noise");
  if (noise)
    fmt::print(
        "noise {:.4g} {}; the second figure is without noise, +- its standard error, by {} trials{}, which "
        "is "
        "known to "
        "{:.0f} %\n",
        report["noise"]["sigma"].get<double>() / height.size, height.name,
        report["noise"]["trials"].get<int>(),
        report["noise"].contains("part")
            ? fmt::format(" on {} samples of 16 parts", report["noise"]["part"].get<std::int64_t>())
            : "",
        100.0 * report["noise"]["error_of_errors"].get<double>());
  for (const ArealGroup& group : kArealGroups) {
    bool headed = false;
    for (const ArealRow& row : kArealRows) {
      if (std::string_view(row.group) != group.word || !report.contains(row.key)) continue;
      if (!headed) fmt::print("\n{}\n", group.heading);
      headed = true;
      const Report& value = report[row.key];
      if (value.is_null())
        fmt::print("{:<8} not stated: {}\n", row.name, reasonOf(report, row.key));
      else
        printRow(row.name, value, row.quantity, shownAs(row.quantity, height, length), textWith(row, report),
                 effectOn(report, row.key), noise);
    }
    if (!isFunctional(group) || !report.contains("smr")) continue;
    const Shown ratio = shownAs(Quantity::kRatio, height, length);
    const Shown level = shownAs(Quantity::kHeight, height, length);
    for (const Report& each : report["smr"])
      printRow("Smr(c)", each["ratio"], Quantity::kRatio, ratio,
               fmt::format("material ratio at {:.5g} {} about the mean",
                           each["height"].get<double>() * level.factor, level.unit),
               noise ? each : Report(), noise);
    for (const Report& each : report["smc"])
      printRow("Smc(mr)", each["height"], Quantity::kHeight, level,
               fmt::format("height about the mean of a material ratio of {:.5g} %",
                           each["ratio"].get<double>() * 100.0),
               noise ? each : Report(), noise);
    for (const auto& [key, name, text] : {std::tuple("material_volume", "Vm(p)", "material volume above"),
                                          {"void_volume", "Vv(p)", "void volume below"}})
      for (const Report& each : report["smc"])
        if (each.contains(key))
          printRow(name, each[key], Quantity::kVolume, shownAs(Quantity::kVolume, height, length),
                   fmt::format("{} the height of a material ratio of {:.5g} %", text,
                               each["ratio"].get<double>() * 100.0),
                   effectOnVolume(each, key), noise);
    if (report.contains("sdc"))
      printRow("Sdc", report["sdc"]["height"], Quantity::kHeight, level, sdcText(report["sdc"]),
               noise ? report["sdc"] : Report(), noise);
  }
}

std::vector<ArealLine> arealLines(const std::vector<Report>& reports, const ReadAs& across,
                                  const std::optional<ReadAs>& heights) {
  const Report& first = reports.front();
  const ReadAs height = readHeightsAs(reports, heights ? *heights : unitOfSq(first));
  std::vector<ArealLine> lines;
  for (const ArealGroup& group : kArealGroups) {
    for (const ArealRow& row : kArealRows) {
      if (std::string_view(row.group) != group.word || !first.contains(row.key)) continue;
      const Shown shown = shownAs(row.quantity, height, across);
      ArealLine line{group.heading, row.name, shown.unit, textWith(row, first), {}, {}};
      for (const Report& report : reports) {
        line.values.push_back(
            report[row.key].is_null()
                ? reasonOf(report, row.key)
                : inHalfTurn(fmt::format("{:.5g}", report[row.key].get<double>() * shown.factor),
                             row.quantity));
        line.without.push_back(withoutNoise(effectOn(report, row.key), shown.factor, row.quantity));
      }
      lines.push_back(std::move(line));
    }
    if (!isFunctional(group) || !first.contains("sdc")) continue;
    const Shown shown = shownAs(Quantity::kHeight, height, across);
    ArealLine line{group.heading, "Sdc", shown.unit, sdcText(first["sdc"]), {}, {}};
    for (const Report& report : reports) {
      const Report& between = report["sdc"]["height"];
      line.values.push_back(between.is_null() ? "the samples do not determine it"
                                              : fmt::format("{:.5g}", between.get<double>() * shown.factor));
      line.without.push_back(
          withoutNoise(report.contains("noise") ? report["sdc"] : Report(), shown.factor, Quantity::kHeight));
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

std::vector<ArealLine> arealNames(WithSdc sdc) {
  std::vector<ArealLine> lines;
  for (const ArealGroup& group : kArealGroups) {
    for (const ArealRow& row : kArealRows)
      if (std::string_view(row.group) == group.word)
        lines.push_back({group.heading, row.name, {}, row.text, {}, {}});
    if (isFunctional(group) && sdc == WithSdc::kYes)
      lines.push_back({group.heading, "Sdc", {}, kSdcText, {}, {}});
  }
  return lines;
}

std::string arealRows(const std::string& scan, const Report& report) {
  const ReadAs height{report["unit"], 1.0}, length{report["lateral_unit"], 1.0};
  std::string text;
  auto out = std::back_inserter(text);
  const std::string layer = report.value("layer", std::string());
  const auto add = [&](const char* group, const std::string& name, const Report& value, Quantity quantity,
                       const std::string& remark, const Report& effect) {
    const Shown shown = shownAs(quantity, height, length);
    const auto number = [&shown, quantity](const Report& of) {
      return of.is_null() ? "" : inHalfTurn(fmt::format("{:.9g}", of.get<double>() * shown.factor), quantity);
    };
    fmt::format_to(out, "{},{},{},{},{},{},{},{},{}\n", csvField(scan), group, csvField(name), number(value),
                   shown.unit, csvField(remark), effect.is_null() ? "" : number(effect["without"]),
                   effect.is_null() ? "" : number(effect["error"]), layer);
  };
  for (const ArealRow& row : kArealRows)
    if (report.contains(row.key)) {
      const Report& value = report[row.key];
      add(row.group, row.name, value, row.quantity,
          value.is_null() ? "not stated: " + reasonOf(report, row.key)
                          : withoutRemark(effectOn(report, row.key)),
          effectOn(report, row.key));
    }
  if (!report.contains("smr")) return text;
  for (const Report& each : report["smr"])
    add("functional", fmt::format("Smr({:.9g})", each["height"].get<double>()), each["ratio"],
        Quantity::kRatio, withoutRemark(each), report.contains("noise") ? each : Report());
  for (const Report& each : report["smc"])
    add("functional", fmt::format("Smc({:.9g} %)", each["ratio"].get<double>() * 100.0), each["height"],
        Quantity::kHeight, withoutRemark(each), report.contains("noise") ? each : Report());
  for (const auto& [key, name] : {std::pair("material_volume", "Vm"), {"void_volume", "Vv"}})
    for (const Report& each : report["smc"])
      if (each.contains(key)) {
        const Report effect = effectOnVolume(each, key);
        add("functional", fmt::format("{}({:.9g} %)", name, each["ratio"].get<double>() * 100.0), each[key],
            Quantity::kVolume, withoutRemark(effect), effect);
      }
  if (report.contains("sdc"))
    add("functional",
        fmt::format("Sdc({:.9g} to {:.9g} %)", report["sdc"]["ratios"][0].get<double>() * 100.0,
                    report["sdc"]["ratios"][1].get<double>() * 100.0),
        report["sdc"]["height"], Quantity::kHeight, withoutRemark(report["sdc"]),
        report.contains("noise") ? report["sdc"] : Report());
  return text;
}

}  // namespace fettle::app
